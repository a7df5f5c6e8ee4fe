#pragma once
// Marks of the processes that may write a journal: files in its folder, each created exclusively by one process and
// named after it. So a name never stands for the files of two processes, and no name is ever used again:
//
//     JOURNAL.HOST.PROCESS.KERNEL.START.FOLDER.COUNT.lock
//
// A process makes its mark, then looks for others. At least the later one of two processes sees the other, without any
// lock of the system. Whether the owner of a mark has ended follows from its name; across computers it often does not.
//
// Any thread may call these.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/writers/hold.h"

namespace shvr {

struct WriterMark {
    enum class Owner {
        running,
        unknown,  ///< owner is on another computer, in another container, or from before a restart
        ended,
    };
    std::filesystem::path path;
    Owner owner = Owner::unknown;
    Holder holder{};            ///< as stated in the mark's file, or else derived from its name and time
    bool is_described = false;  ///< false: the mark's owner has not looked for others yet
};

/// Creates this process's mark. Null if that is impossible; `error` is the reason.
std::optional<std::filesystem::path> make_mark(const std::filesystem::path& journal, int& error);
/// Writes the holder into the mark. Failures are ignored, since the mark's name is sufficient.
void describe_mark(const std::filesystem::path& mark, const Holder& holder);

/// All marks of a journal except `own`. Null if the folder cannot be listed.
std::optional<std::vector<WriterMark>> marks_of(const std::filesystem::path& journal,
                                                const std::filesystem::path& own = {});

/// The name given to a mark whose owner must not write any more. A revoked mark still counts as a mark.
std::filesystem::path revoked(const std::filesystem::path& mark);

}  // namespace shvr
