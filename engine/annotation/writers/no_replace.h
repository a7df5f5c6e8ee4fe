#pragma once
// Gives a file a name that no other file has, even if other processes move files at the same moment. A check before
// rename(2) would leave a gap in which another process's file could be replaced. Any thread may call these.

#include <filesystem>

namespace shvr {

enum class Renaming {
    done,
    name_taken,  ///< `to` exists; nothing has changed
    gone,        ///< there is no `from`
};

/// Renames the file or folder `from`, which other processes may move at the same time. `to` must be a name from which
/// no process moves files away. Fails only for reasons that `Renaming` does not list.
Renaming move_to_free(const std::filesystem::path& from, const std::filesystem::path& to);

/// Gives a file (following symbolic links from `from`) the second name `to`, under which its content stays when another
/// file replaces it. If the file system has no hard links, copies it; if the process ends meanwhile, `to` is
/// incomplete, but `from` is unchanged. Fails like `move_to_free`.
Renaming link_to_free(const std::filesystem::path& from, const std::filesystem::path& to);

/// Renames `own`, a name only this process knows, to `to`, which others may move. Fails like `move_to_free`.
Renaming put_at_free(const std::filesystem::path& own, const std::filesystem::path& to);

}  // namespace shvr
