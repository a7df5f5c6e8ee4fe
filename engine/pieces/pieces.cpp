#include "engine/pieces/pieces.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <random>
#include <span>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr int64_t MAX_MANIFEST_BYTES = int64_t{64} << 20;
constexpr const char* SUFFIX = ".pieces";
constexpr std::string_view OWN_MANIFEST = ".manifest-";
constexpr std::chrono::hours OLD{24};
/// Headers whose voxels may be in another file, and how the names of such files go on after the header's stem.
constexpr std::string_view HEADERS[] = {".nhdr", ".mhd", ".hdr"};
constexpr std::string_view VOXEL_FILES[] = {".raw", ".img", ".zraw", ".bin", ".dat"};

std::string text_of(const PieceManifest& manifest)
{
    const nlohmann::ordered_json json = {{"shvr_pieces", 1},
                                         {"version", manifest.version},
                                         {"command", manifest.command},
                                         {"folder", manifest.folder.string()},
                                         {"tasks", manifest.tasks},
                                         {"inputs", manifest.inputs}};
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::vector<std::string> texts_of(const JsonNode& list, size_t least)
{
    std::vector<std::string> texts;
    for (const JsonNode& element : list.elements(least)) texts.push_back(element.any_text());
    return texts;
}

PieceManifest manifest_in(const JsonNode& root)
{
    root.required("shvr_pieces", "1, as shvr writes it").whole(1, 1);
    const JsonNode folder = root.required("folder", "the folder in which the tasks ran");
    PieceManifest manifest{.version = root.required("version", "the version of shvr").text(),
                           .command = texts_of(root.required("command", "the arguments of the tasks"), 1),
                           .folder = folder.text(),
                           .tasks = root.required("tasks", "the number of tasks").whole(1, MAX_TASKS),
                           .inputs = texts_of(root.required("inputs", "the files that tasks read"), 0)};
    if (!manifest.folder.is_absolute()) folder.refuse("the path of a folder from the root, as in /data/scans");
    return manifest;
}

/// Removes manifests of killed tasks that have been published, or can no longer be.
void collect_own_manifest(const fs::directory_entry& entry)
{
    std::error_code error;
    if (!entry.path().filename().string().starts_with(OWN_MANIFEST)) return;
    const bool is_published = entry.hard_link_count(error) > 1 && !error;
    const fs::file_time_type written = entry.last_write_time(error);
    if (is_published || (!error && fs::file_time_type::clock::now() - written > OLD)) fs::remove(entry.path(), error);
}

std::string joined(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

/// Gives a complete file its final name, unless a file with that name exists. Returns whether it did.
bool publish(const fs::path& file, const fs::path& target)
{
    if (::link(file.c_str(), target.c_str()) == 0) return true;
    if (errno == EEXIST) return false;
    // A file system without links: of two first tasks at the same instant, the later one's manifest stays, and both are
    // compared with it.
    const int link_error = errno;
    std::error_code error;
    if (fs::exists(target, error)) return false;
    if (::rename(file.c_str(), target.c_str()) != 0)
        fail(target.string(), ": cannot be written: ", reason_of(link_error));
    return true;
}

std::string signature_of_file(const fs::path& path)
{
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return sentence(path.string(), " missing");
    return sentence(path.string(), " ", status.st_size, " ", status.st_mtim.tv_sec, ".", status.st_mtim.tv_nsec);
}

/// Returns the files that may hold a header's voxels: headers are not read here.
std::vector<fs::path> voxel_files_of(const fs::path& header)
{
    std::vector<fs::path> files;
    if (std::ranges::find(HEADERS, header.extension().string()) == std::end(HEADERS)) return files;
    for (const std::string_view extension : VOXEL_FILES)
        for (const char* const packed : {"", ".gz", ".bz2"}) {
            const fs::path file = header.parent_path() / sentence(header.stem().string(), extension, packed);
            std::error_code ignored;
            if (fs::exists(file, ignored)) files.push_back(file);
        }
    return files;
}

}  // namespace

Pieces Pieces::of_output(const fs::path& output)
{
    const fs::path whole = fs::absolute(output).lexically_normal();
    fs::path folder = whole.has_filename() ? whole : whole.parent_path();
    return Pieces(folder += SUFFIX);
}

Pieces Pieces::of_manifest(const fs::path& manifest)
{
    fs::path folder = fs::absolute(manifest).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    const Pieces of_result = of_output(folder), of_folder(folder);
    std::error_code ignored;
    if (fs::exists(of_result.manifest_path(), ignored)) return of_result;
    if (fs::exists(of_folder.manifest_path(), ignored) || folder.extension() == SUFFIX) return of_folder;
    return folder == Pieces(folder.parent_path()).manifest_path() ? Pieces(folder.parent_path()) : of_result;
}

fs::path Pieces::piece(int64_t task) const
{
    return folder_ / sentence("piece-", task);
}

bool Pieces::has(int64_t task) const
{
    std::error_code ignored;
    return fs::exists(piece(task), ignored);
}

void Pieces::begin(const PieceManifest& manifest) const
{
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) fail(folder_.string(), ": cannot be created: ", error.message());
    collect_temporary();
    if (!fs::exists(manifest_path(), error)) {
        const fs::path own = folder_ / sentence(OWN_MANIFEST, std::random_device{}(), "-", ::getpid());
        const std::string text = text_of(manifest);
        write_file_atomically(own, std::as_bytes(std::span(text)));
        publish(own, manifest_path());
        fs::remove(own, error);
    }
    const PieceManifest found = this->manifest();
    if (found.tasks != manifest.tasks)
        fail(manifest_path().string(), ": the job is split into ", counted(found.tasks, "task"),
             ", and this is one of ", manifest.tasks, "; expected the same number in all: --task I/", found.tasks,
             ", or remove ", folder_.string(), " to start over");
    expect_equal(found, manifest);
}

void Pieces::expect_equal(const PieceManifest& found, const PieceManifest& wanted) const
{
    const auto refuse = [&](const char* what, const std::string& there, const std::string& here) {
        fail(manifest_path().string(), ": the first task ", what, " ", there, ", and this one ", here,
             "; expected the same in all tasks: repeat what the first one had, or remove ", folder_.string(),
             " to start over");
    };
    if (found.version != wanted.version) refuse("ran in shvr", found.version, wanted.version);
    if (found.command != wanted.command) refuse("ran shvr", joined(found.command), joined(wanted.command));
    if (found.folder != wanted.folder) refuse("ran in the folder", found.folder.string(), wanted.folder.string());
    if (found.inputs == wanted.inputs) return;
    const size_t shared = std::min(found.inputs.size(), wanted.inputs.size());
    size_t at = 0;
    while (at < shared && found.inputs[at] == wanted.inputs[at]) ++at;
    const auto named = [at](const std::vector<std::string>& inputs) {
        return at < inputs.size() ? inputs[at] : std::string("nothing more");
    };
    refuse("read (name, bytes, time)", named(found.inputs), named(wanted.inputs));
}

PieceManifest Pieces::manifest() const
{
    std::error_code ignored;
    if (!fs::exists(manifest_path(), ignored))
        fail(manifest_path().string(),
             ": is missing; expected the manifest that the first task of a job writes: run "
             "its command with --task 0/N");
    const std::string text = read_text(manifest_path(), MAX_MANIFEST_BYTES);
    try {
        return manifest_in(
            JsonDocument(text, manifest_path().string(), {.expected = "what the first task wrote"}).root());
    } catch (const Error& error) {
        fail(error.what(), ": remove this file, and run any task of the job again, which writes it again");
    }
}

void Pieces::collect_temporary() const
{
    collect_temporary_files(folder_);
    std::error_code error;
    for (fs::directory_iterator entry(folder_, error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
        collect_own_manifest(*entry);
        if (entry->path().extension() != ".part") continue;
        collect_temporary_files(entry->path());
        collect_temporary_files(entry->path() / "shvr");
    }
}

std::vector<std::string> Pieces::missing(int64_t of) const
{
    std::vector<std::string> names;
    for (int64_t task = 0; task < of; ++task)
        if (!has(task)) names.push_back(TaskChoice{task, of}.in_words());
    return names;
}

void Pieces::expect_all(int64_t of) const
{
    const std::vector<std::string> names = missing(of);
    if (names.empty()) return;
    constexpr size_t MAX_NAMED = 20;
    std::string listed;
    for (size_t i = 0; i < std::min(names.size(), MAX_NAMED); ++i) listed += (i == 0 ? "" : ", ") + names[i];
    if (names.size() > MAX_NAMED) listed += sentence(" and ", names.size() - MAX_NAMED, " more");
    throw MissingPieces(sentence(folder_.string(), ": ", counted(int64_t(names.size()), "piece"), " of ", of,
                                 names.size() == 1 ? " is" : " are", " missing: ", listed,
                                 "; expected all: run the job's command again with --task for each of these"),
                        names);
}

void Pieces::remove() const
{
    std::error_code error;
    fs::remove_all(folder_, error);
    if (error) fail(folder_.string(), ": cannot be removed: ", error.message());
}

std::vector<std::string> input_signatures(const fs::path& path)
{
    std::error_code ignored;
    if (path.empty()) return {};
    if (path.string().find("://") != std::string::npos) return {path.string()};
    std::vector<std::string> lines;
    if (!fs::is_directory(path, ignored)) {
        lines.push_back(signature_of_file(path));
        for (const fs::path& file : voxel_files_of(path)) lines.push_back(signature_of_file(file));
        return lines;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(path, ignored))
        if (!entry.is_directory(ignored)) lines.push_back(signature_of_file(entry.path()));
    std::ranges::sort(lines);
    return lines;
}

}  // namespace shvr
