#pragma once
// Gives a file a name that no other file has, even if other processes move files at the same moment: checking before
// rename(2) would leave a gap in which another process's file could be replaced. Any thread may call these.

#include <filesystem>

namespace shvr {

enum class Renaming {
    done,
    name_taken,  ///< `to` exists; nothing has changed
    gone,        ///< there is no `from`
};

/// Renames the file or folder `from`, which other processes may move at the same time. `to` must be a name that no
/// process moves files away from. Fails only for reasons other than those of `Renaming`.
Renaming move_to_free(const std::filesystem::path& from, const std::filesystem::path& to);

/// Gives the file to which `from` leads the second name `to`, under which its content stays when another file replaces
/// it. Copies it where the file system has no such links; if the process then ends meanwhile, `to` is incomplete, but
/// `from` is as it was. Fails like `move_to_free`.
Renaming link_to_free(const std::filesystem::path& from, const std::filesystem::path& to);

/// Renames `own`, a name known to this process only, to `to`, from which others may move it. Fails like `move_to_free`.
Renaming put_at_free(const std::filesystem::path& own, const std::filesystem::path& to);

}  // namespace shvr
