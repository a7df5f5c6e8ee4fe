#pragma once
// Marks of the processes that may write a journal: files in the journal's folder, each created
// exclusively by one process and named after it. So no two processes share a name, and no name is ever
// used again:
//
//     JOURNAL.HOST.PROCESS.KERNEL.START.FOLDER.COUNT.lock
//
// A process makes its mark, then looks for others. So at least the later of two processes sees the other,
// even without system locks. Whether the owner of a mark has ended follows from its name, but often not
// across computers.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/writers/hold.h"

namespace shvr {

struct WriterMark {
    enum class Owner {
        running,
        unknown,  ///< on another computer, in another container, or from before a restart
        ended,
    };
    std::filesystem::path path;
    Owner owner = Owner::unknown;
    Holder holder{};            ///< from the mark's file or, without content, from its name and time
    bool is_described = false;  ///< false: the mark's owner has not looked for others yet
};

/// Creates this process's mark. Null if that is impossible; then `error` is the reason.
std::optional<std::filesystem::path> make_mark(const std::filesystem::path& journal, int& error);
/// Writes the holder into the mark. Ignores failures, because the mark's name is sufficient.
void describe_mark(const std::filesystem::path& mark, const Holder& holder);

/// All marks of a journal except `own`. Null if the folder cannot be listed.
std::optional<std::vector<WriterMark>> marks_of(const std::filesystem::path& journal,
                                                const std::filesystem::path& own = {});

/// The new name of a mark whose owner must not write any more. A revoked mark still counts as a mark.
std::filesystem::path revoked(const std::filesystem::path& mark);

}  // namespace shvr
