#pragma once
// Gives a file a name that no other file has, even if another process takes that name at the same moment: a check
// before rename(2) would leave a gap in which the other file is replaced. Any thread may call these.

#include <filesystem>

namespace shvr {

/// Renames a file or folder. Returns false, having changed nothing, if `to` exists; fails if it cannot.
bool rename_to_free(const std::filesystem::path& from, const std::filesystem::path& to);

/// Gives a file a second name. Returns false, having changed nothing, if `to` exists, and EEXIST in `error`, or if the
/// file system has no hard links.
bool link_to_free(const std::filesystem::path& from, const std::filesystem::path& to, int& error);

}  // namespace shvr
