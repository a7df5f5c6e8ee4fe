#pragma once
// The single writer of a journal: from opening for writing until closing, one process holds JOURNAL.lock, which
// describes it. The hold is a lock of the system (open file description), so it ends with the process, even in a crash;
// a file left by a dead process holds nothing. Readers take no lock and can query the holder.
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

/// Another process is writing the journal, or has written it since it was read.
class JournalTaken : public Error {
public:
    using Error::Error;
};

/// The content of JOURNAL.lock; missing parts are empty.
struct Holder {
    std::string program;  ///< "shvr annotate"
    std::string process;  ///< process id
    std::string host, user;
    std::string since;  ///< local time, "2026-11-22 13:20:05"
};
/// "shvr annotate, process 4711 on lab3 of user ada, since 2026-11-22 13:20:05"
std::string in_words(const Holder& holder);

class Hold {
public:
    /// Fails with JournalTaken, naming the holder, if another hold (also in this process) exists on the journal. Null
    /// if no lock can be taken: there is no journal, its folder is not writable, or its file system has no locks.
    /// `program`: as in Holder.
    static std::shared_ptr<Hold> take(const std::filesystem::path& journal, std::string_view program);
    /// Releases the lock, and removes the file.
    ~Hold();
    Hold(const Hold&) = delete;

    const std::filesystem::path& journal() const { return journal_; }

private:
    Hold(std::filesystem::path journal, FileDescriptor file);
    std::filesystem::path journal_;
    FileDescriptor file_;
};

/// The process that holds a journal; null if there is none, or it cannot be determined.
std::optional<Holder> holder_of(const std::filesystem::path& journal);

/// "scan.journal.lock" for "scan.journal".
std::filesystem::path lock_path(const std::filesystem::path& journal);

}  // namespace shvr
