#pragma once
// The single writer of a journal. One process holds the journal, from opening to closing it, by a mark and a lock:
//
// - The process's own mark in the journal's folder (writer_mark.h), which no other process can create or mistake.
//   Marks decide which process may write: a process that finds the mark of a running process is refused. If it is
//   unknown whether a mark's owner has ended, other processes do not write its file but continue in a copy (`claim`).
// - A lock of the system on JOURNAL.lock (open file description), if the file system has locks. The lock ends with the
//   process, other computers see it, and older programs know it.
//
// Readers need neither, and can query the holder. One thread at a time, except where stated.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

/// Thrown if another process is writing the journal, or has written it since it was read.
class JournalTaken : public Error {
public:
    using Error::Error;
};

/// The content of JOURNAL.lock and of marks; missing parts are empty.
struct Holder {
    std::string program;  ///< "shvr annotate"
    std::string process;  ///< process id
    std::string host, user;
    std::string since;            ///< local time, "2026-11-22 13:20:05"
    bool may_have_ended = false;  ///< not known on this computer
};
/// "shvr annotate, process 4711 on lab3 of user ada, since 2026-11-22 13:20:05"
std::string in_words(const Holder& holder);

class Hold {
public:
    /// Fails with JournalTaken, naming the holder, if the journal has another hold, even in this process. Returns null
    /// if there is no journal, or if no file can be created next to it; then `error` is the reason. `program`: as in
    /// Holder.
    static std::shared_ptr<Hold> take(const std::filesystem::path& journal, std::string_view program, int& error);
    static std::shared_ptr<Hold> take(const std::filesystem::path& journal, std::string_view program);
    /// Releases the lock, and removes the files.
    ~Hold();
    Hold(const Hold&) = delete;

    const std::filesystem::path& journal() const { return journal_; }
    /// False if another process has claimed the journal meanwhile. This process must then not begin to write the
    /// journal; records that it still writes to its open file are not part of the claimed journal. Any thread.
    bool is_kept() const;
    /// Another process that writes the journal now; null if there is none.
    std::optional<Holder> successor() const;
    /// A file name in the journal's folder that no other process uses.
    std::filesystem::path own_name() const;
    /// Releases only the lock, so that this process can take a new hold after it has lost this one.
    void unlock() { lock_.reset(); }

    /// Processes that held the journal and may still hold it, because it is unknown here whether they have ended.
    const std::vector<Holder>& doubtful() const { return doubtful_; }
    /// Takes the journal from the doubtful processes. Returns false if all of them have closed it meanwhile. If it
    /// returns true, do not write their file: rename it, put a copy in its place, and then call `end_claim`.
    bool claim();
    void end_claim();

private:
    Hold(std::filesystem::path journal, std::filesystem::path mark);
    bool looks_alone(bool is_last_try);

    std::filesystem::path journal_, mark_;
    std::optional<FileDescriptor> lock_;
    std::vector<Holder> doubtful_;
    std::vector<std::filesystem::path> doubtful_marks_;
};

/// The process that holds a journal; null if there is none or it cannot be determined.
std::optional<Holder> holder_of(const std::filesystem::path& journal);

/// "scan.journal.lock" for "scan.journal".
std::filesystem::path lock_path(const std::filesystem::path& journal);

}  // namespace shvr
