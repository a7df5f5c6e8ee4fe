#include "ui/files/folder_reader.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iterator>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/open_volume.h"

namespace shvr::ui {

namespace fs = std::filesystem;

namespace {

/// Number of names that are read to determine a folder's kind.
constexpr int SAMPLED_NAMES = 64;

constexpr const char* ANNOTATION_ENDINGS[] = {".mask", ".offsets", ".graphml", ".swc", ".journal"};

std::string local_time(fs::file_time_type time)
{
    const std::time_t seconds = std::chrono::system_clock::to_time_t(
        std::chrono::time_point_cast<std::chrono::system_clock::duration>(std::chrono::file_clock::to_sys(time)));
    std::tm parts{};
    std::array<char, 32> text{};
    if (!localtime_r(&seconds, &parts)) return {};
    return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M", &parts)};
}

FileKind kind_of_folder(const fs::path& folder)
{
    std::error_code ignored;
    if (fs::exists(folder / "shvr" / "session.json", ignored)) return FileKind::project;
    for (const char* name : {".zattrs", "zarr.json", ".zgroup", ".zarray"})
        if (fs::exists(folder / name, ignored)) return FileKind::zarr;
    int seen = 0, slices = 0, dicoms = 0;
    std::error_code error;
    for (fs::directory_iterator each(folder, error); !error && each != fs::directory_iterator();
         each.increment(error)) {
        const std::string name = lower_case(each->path().filename().string());
        const std::string_view format = format_of_name(name);
        slices += format == "TIFF" || format == "PNG" || format == "BMP" || format == "JPEG";
        dicoms += name.ends_with(".dcm");
        if (++seen == SAMPLED_NAMES) break;
    }
    if (2 * dicoms > seen) return FileKind::dicom_series;
    return slices >= 2 && 2 * slices > seen ? FileKind::slices : FileKind::folder;
}

const char* text_of(FileKind kind)
{
    switch (kind) {
        case FileKind::project: return "SHVR project";
        case FileKind::zarr: return "OME-Zarr volume";
        case FileKind::dicom_series: return "DICOM series";
        case FileKind::slices: return "slices";
        case FileKind::folder: return "folder";
        case FileKind::volume: return "volume";
        case FileKind::session: return "SHVR session";
        case FileKind::annotation: return "annotation";
        case FileKind::other: break;
    }
    return "";
}

/// Returns whether a file is a session, which its first bytes state.
bool begins_as_session(const fs::path& path)
{
    std::array<char, 256> head{};
    std::ifstream file(path, std::ios::binary);
    file.read(head.data(), head.size());
    return std::string_view(head.data(), size_t(file.gcount())).find("\"shvr_session\"") != std::string_view::npos;
}

std::string reason(const std::error_code& error)
{
    return error == std::errc::permission_denied           ? "it may not be read"
           : error == std::errc::no_such_file_or_directory ? "it is not there"
           : error == std::errc::not_a_directory           ? "it is no folder"
                                                           : error.message();
}

}  // namespace

FileDetails details_of(const fs::path& path)
{
    FileDetails details;
    std::error_code error;
    const fs::file_time_type changed = fs::last_write_time(path, error);
    if (!error) details.changed = local_time(changed);
    const std::string name = lower_case(path.filename().string());
    if (fs::is_directory(path, error)) {
        details.kind = kind_of_folder(path);
        details.kind_text = text_of(details.kind);
        return details;
    }
    if (const uintmax_t bytes = fs::file_size(path, error); !error) details.bytes = int64_t(bytes);
    const std::string_view format = format_of_name(name);
    if (name.ends_with(".json") && begins_as_session(path))
        details.kind = FileKind::session;
    else if (!format.empty())
        details.kind = FileKind::volume;
    else if (name.ends_with(".mask.json") ||
             std::ranges::any_of(ANNOTATION_ENDINGS, [&](const char* ending) { return name.ends_with(ending); }))
        details.kind = FileKind::annotation;
    details.kind_text = details.kind == FileKind::volume ? std::string(format) : text_of(details.kind);
    return details;
}

FolderReader::FolderReader(fs::path folder, size_t at_once) : shared_(std::make_shared<Shared>())
{
    shared_->folder = std::move(folder);
    std::thread([shared = shared_, at_once] {
        try {
            read(*shared, at_once);
        } catch (const std::exception& error) {
            const std::scoped_lock lock(shared->mutex);
            shared->news.failure = sentence(shared->folder.string(), ": only part of it can be listed: ", error.what());
            shared->news.is_reading = false;
            shared->changed.notify_all();
        }
    }).detach();
}

FolderReader::~FolderReader()
{
    const std::scoped_lock lock(shared_->mutex);
    shared_->is_abandoned = true;
    shared_->changed.notify_all();
}

FolderReader::News FolderReader::take()
{
    const std::scoped_lock lock(shared_->mutex);
    News& news = shared_->news;
    News taken{std::exchange(news.entries, {}), std::exchange(news.details, {}), news.failure, news.is_reading};
    return taken;
}

void FolderReader::ask_about(std::string name)
{
    const std::scoped_lock lock(shared_->mutex);
    shared_->wanted.push_back(std::move(name));
    shared_->changed.notify_all();
}

void FolderReader::wait(std::chrono::milliseconds patience)
{
    std::unique_lock lock(shared_->mutex);
    shared_->changed.wait_for(lock, patience, [&] { return !shared_->news.is_reading; });
}

/// Runs on the reader's thread: lists names and answers requests in between; then only answers, until abandoned.
void FolderReader::read(Shared& shared, size_t at_once)
{
    std::error_code error, ignored;
    fs::directory_iterator next(shared.folder, error);
    std::string failure = error ? sentence(shared.folder.string(), ": cannot be listed: ", reason(error)) : "";
    if (error) next = {};
    for (bool is_reading = true; is_reading;) {
        std::vector<FolderEntry> entries;
        for (size_t most = at_once; most > 0 && next != fs::directory_iterator(); --most) {
            // Most file systems deliver the kind of an entry with its name; only links need another query.
            entries.push_back({next->path().filename().string(), next->is_directory(ignored)});
            next.increment(error);
            if (!error) continue;
            failure = sentence(shared.folder.string(), ": only part of it can be listed: ", reason(error));
            next = {};
        }
        is_reading = next != fs::directory_iterator();
        {
            const std::scoped_lock lock(shared.mutex);
            News& news = shared.news;
            std::ranges::move(entries, std::back_inserter(news.entries));
            news.failure = failure;
            news.is_reading = is_reading;
            if (shared.is_abandoned) return;
        }
        shared.changed.notify_all();
        while (answer(shared)) {
        }
    }
    for (;;) {
        {
            std::unique_lock lock(shared.mutex);
            shared.changed.wait(lock, [&] { return shared.is_abandoned || !shared.wanted.empty(); });
            if (shared.is_abandoned) return;
        }
        answer(shared);
    }
}

/// Answers the oldest request. Returns false if no request is pending, or if the reader was abandoned.
bool FolderReader::answer(Shared& shared)
{
    std::string name;
    {
        const std::scoped_lock lock(shared.mutex);
        if (shared.is_abandoned || shared.wanted.empty()) return false;
        name = std::move(shared.wanted.front());
        shared.wanted.erase(shared.wanted.begin());
    }
    FileDetails details = details_of(shared.folder / name);
    const std::scoped_lock lock(shared.mutex);
    shared.news.details.emplace_back(std::move(name), std::move(details));
    return true;
}

}  // namespace shvr::ui
