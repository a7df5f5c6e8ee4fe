#pragma once
// Finds annotation in the folder of a scan. Asks the disk, so the main thread calls it by ui/files/asked.h.

#include <filesystem>
#include <string>
#include <vector>

namespace shvr::ui {

struct FoundFile {
    std::filesystem::path path;
    std::string name;   ///< without its folder
    std::string about;  ///< "1.2 MB"
};

/// Returns files in the folder that look like masks, offsets or traces by their names: first those whose names begin
/// with one of `stems`, as "leaf-mask.nrrd" with "leaf", and of each kind the newest first. `own`: files that the open
/// session reads or writes, which are left out.
std::vector<FoundFile> annotation_beside(const std::filesystem::path& folder,
                                         const std::vector<std::filesystem::path>& own,
                                         const std::vector<std::string>& stems = {});

/// What is at a path. Folders that hold an image count as files; other folders are on the way to a file that is typed.
enum class There { nothing, folder, file };
There what_is_at(const std::filesystem::path& path);

}  // namespace shvr::ui
