#include "engine/tasks/import_estimate.h"

#include "engine/projects/import_prepare.h"
#include "engine/session/session.h"
#include "engine/tasks/file_content.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

/// The space that is free where the folder will be made; it and the folders around it may not exist yet.
std::optional<double> free_space(fs::path folder)
{
    std::error_code error;
    folder = fs::absolute(folder, error);
    while (!error && !fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    const fs::space_info space = fs::space(folder, error);
    return error ? std::nullopt : std::optional(double(space.available));
}

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
    if (is_taken(task.project)) estimate.free_name = free_name_beside(task.project);
    return estimate;
}

}  // namespace shvr
