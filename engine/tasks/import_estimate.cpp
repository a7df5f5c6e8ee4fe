#include "engine/tasks/import_estimate.h"

#include <algorithm>
#include <initializer_list>

#include "engine/annotation/writers/hold.h"
#include "engine/base/text.h"
#include "engine/projects/foreign_content.h"
#include "engine/projects/import_prepare.h"
#include "engine/projects/part_folder.h"
#include "engine/session/session.h"
#include "engine/tasks/file_content.h"
#include "engine/tasks/task_output.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

bool is_taken(const fs::path& path)
{
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

fs::path free_name_beside(const fs::path& path)
{
    for (int number = 2;; ++number)
        if (fs::path free = sentence(path.string(), '-', number); !is_taken(free)) return free;
}

/// Adds what a folder of a project has of one kind of annotation: "paint (labels/paint)".
template <class Is>
void add_kind(std::string& kinds, const char* kind, const fs::path& project, const char* folder, const Is& is)
{
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(project / folder, ignored))
        if (is(entry)) {
            kinds +=
                sentence(kinds.empty() ? "" : ", ", kind, " (", folder, "/", entry.path().filename().string(), ")");
            return;
        }
}

/// Returns the annotation in a project's folder in words. Sessions that name files elsewhere are not followed.
std::string annotation_in(const fs::path& project)
{
    const auto ends_in = [](const fs::directory_entry& entry, std::initializer_list<const char*> endings) {
        const std::string ending = lower_case(entry.path().extension().string());
        return std::ranges::find(endings, ending) != endings.end();
    };
    std::string kinds;
    add_kind(kinds, "paint", project, "labels", [](const fs::directory_entry& entry) {
        std::error_code ignored;
        return entry.is_directory(ignored);
    });
    add_kind(kinds, "density offsets", project, "shvr", [&](const fs::directory_entry& entry) {
        return ends_in(entry, {".zarr", ".offset"});
    });
    add_kind(kinds, "a trace", project, "shvr", [&](const fs::directory_entry& entry) {
        return ends_in(entry, {".graphml", ".swc", ".rsml"});
    });
    add_kind(kinds, "the history of the work", project, "shvr",
             [&](const fs::directory_entry& entry) { return ends_in(entry, {".journal"}); });
    return kinds;
}

/// Returns why the project that is there cannot be replaced, in words for a dialog; empty: it can.
std::string why_not_replaced(const ImportTask& task, const FoundTarget& found)
{
    constexpr const char* ANOTHER = "; expected a new name";
    const std::string project = task.project.string();
    std::error_code ignored;
    if (!found.is_project)
        return sentence(project,
                        fs::is_directory(task.project, ignored) ? ": is a folder, but no project" : ": is a file",
                        ANOTHER);
    if (!found.foreign.empty())
        return sentence(project, ": holds ", shvr::in_words(found.foreign), ", no part of it", ANOTHER);
    if (!task.overwrite) return sentence(project, ": exists already", ANOTHER, ", or Overwrite under More");
    if (const std::optional<Holder> holder = holder_of(journal_beside(task.project / "shvr" / "session.json")))
        return sentence(project, ": is open for writing in ", in_words(*holder), "; expected it to be closed first");
    return {};
}

/// Fails for a session file, which several commands take in place of a volume.
void refuse_session(const fs::path& path)
{
    std::error_code ignored;
    if (lower_case(path.extension().string()) != ".json" || !fs::is_regular_file(path, ignored)) return;
    if (what_is(path, nullptr).content != FileContent::session) return;
    fail(path.string(), ": is a session; expected a volume; give the file that its key volume.path names");
}

}  // namespace

std::unique_ptr<VolumeSource> open_for_import(const ImportTask& task)
{
    const OpenOptions& choice = task.choice;
    const std::string volume = task.volume.string();
    refuse_session(task.volume);
    if (task.raw.empty()) return open_volume(volume, choice);
    RawLayout layout = parse_raw_layout(task.raw);
    if (choice.spacing) layout.spacing = *choice.spacing;
    if (!choice.unit.empty()) layout.unit = choice.unit;
    return open_raw(volume, layout);
}

ImportEstimate estimate_of(const ImportTask& task)
{
    constexpr double LEVELS = 8.0 / 7.0;  // each level has an eighth of the voxels of the one before
    check(task);
    const std::unique_ptr<VolumeSource> source = open_for_import(task);
    const std::unique_ptr<Preparation> prepared =
        make_preparation(*source, {.crop = task.crop, .downscale = task.downscale});
    const VolumeInfo& made = prepared->info();
    ImportEstimate estimate{.scan = source->info(),
                            .size = made.size,
                            .most_bytes = LEVELS * double(voxel_count(made)) * double(bytes_of(made.type)),
                            .free_bytes = free_space(task.project)};
    return estimate;
}

ImportPlace look_at_place(const ImportTask& task)
{
    ImportPlace place;
    try {
        check_new_folder(task.project);
        const FoundTarget found = found_at(task.project);
        if (is_taken(task.project)) place.free_name = free_name_beside(task.project);
        if (!found.is_taken) return place;
        place.is_project = found.is_project && found.foreign.empty();
        if (place.is_project) place.annotation = annotation_in(task.project);
        place.why_not = why_not_replaced(task, found);
        if (place.why_not.empty()) refuse_own_source(task);
    } catch (const Error& error) {
        place.why_not = error.what();
    }
    return place;
}

}  // namespace shvr
