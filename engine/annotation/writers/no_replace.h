#pragma once
// Gives a file a name that no other file has, even if other processes move files at the same moment: a check before
// rename(2) would leave a gap in which the other file is replaced. Any thread may call these.

#include <filesystem>

namespace shvr {

enum class Renaming {
    done,
    name_taken,  ///< `to` exists; nothing has changed
    gone,        ///< there is no `from`
};

/// Renames the file or folder that has a name, which other processes may move at the same time, to a name from which
/// nothing is moved again. Fails if it cannot for another reason than those.
Renaming move_to_free(const std::filesystem::path& from, const std::filesystem::path& to);

/// Renames a file that only this process knows to a name from which others may move it. Fails as above.
Renaming put_at_free(const std::filesystem::path& own, const std::filesystem::path& to);

}  // namespace shvr
