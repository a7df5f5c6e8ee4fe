#pragma once
// Who writes a journal: from opening for writing until closing, one process holds JOURNAL.lock, which says who that is.
// The hold is a lock of the system (open file description), so it ends with the process however that ends; a file that
// a dead process left holds nothing. Those who only look take no lock and can ask who holds it.
//
// One thread at a time.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

/// Another process writes the journal, or has written it since it was read.
class JournalTaken : public Error {
public:
    using Error::Error;
};

/// As JOURNAL.lock says; a part that it does not say is empty.
struct Holder {
    std::string program;  ///< "shvr annotate"
    std::string process;  ///< its number
    std::string host, user;
    std::string since;  ///< local time, "2026-11-22 13:20:05"
};
/// "shvr annotate, process 4711 on lab3 of user ada, since 2026-11-22 13:20:05"
std::string in_words(const Holder& holder);

class Hold {
public:
    /// Fails with JournalTaken, naming the holder, where another one (also of this process) holds the journal. Null
    /// where no lock can be kept: there is no journal, its folder may not be written to, or its file system has no
    /// locks. `program`: as in Holder.
    static std::shared_ptr<Hold> take(const std::filesystem::path& journal, std::string_view program);
    /// Lets go, and removes the file.
    ~Hold();
    Hold(const Hold&) = delete;

    const std::filesystem::path& journal() const { return journal_; }

private:
    Hold(std::filesystem::path journal, FileDescriptor file);
    std::filesystem::path journal_;
    FileDescriptor file_;
};

/// Who holds a journal; nothing where nobody does, or that cannot be known.
std::optional<Holder> holder_of(const std::filesystem::path& journal);

/// "scan.journal.lock" for "scan.journal".
std::filesystem::path lock_path(const std::filesystem::path& journal);

}  // namespace shvr
