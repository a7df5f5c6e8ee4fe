#pragma once
// What an import that was cancelled, or ended with the program, has left next to its project: NAME.part, from which the
// same import goes on. Any thread; waits for the disk.

#include <filesystem>
#include <optional>

namespace shvr {

struct UnfinishedImport {
    std::filesystem::path part;
    double bytes = 0.0;
};

/// Returns what an import into `project` has left; null if there is nothing, or if a process works on it now.
std::optional<UnfinishedImport> unfinished_import(const std::filesystem::path& project);
/// Deletes it. Fails if it was not left by an import, or if a process works on it.
void delete_unfinished_import(const std::filesystem::path& project);

}  // namespace shvr
