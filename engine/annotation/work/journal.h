#pragma once
// The journal: every command of the user, appended to a file as it happens. The journal's thread writes at once (if the
// program is killed, the last milliseconds are lost) and syncs at most every 100 ms (a power cut loses this time and
// the duration of a disk write).
//
//   append (main thread, never waits) -> queue -> frame, write, sync (the journal's thread) -> durable
//
// While writing fails, nothing is lost and no caller waits: records stay in memory, `failure` states the reason, and
// writing is retried every second. Only the process that holds a journal (hold.h) writes it; it also locks the file
// itself, for older programs. A process writes to an existing file only if it held the journal both before and after it
// opened the file. A new file is created exclusively, or under a name that no other process uses.
//
// One thread appends; any thread may query.

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "engine/annotation/work/journal_file.h"
#include "engine/annotation/writers/hold.h"

namespace shvr {

class AtomicWriter;

class Journal {
public:
    /// Continues the valid prefix that `before` describes. Keeps data after this prefix as JOURNAL.rest1, .rest2 and so
    /// on, and repairs a damaged head. Fails if the file cannot be created or written; fails with JournalTaken if
    /// another process holds it. `hold`: null if no other process knows the journal. `own`: a file with a name that
    /// only this process uses, which `before` then describes; it moves to `path`, and any file there is renamed first.
    Journal(const std::filesystem::path& path, JournalScan before, std::shared_ptr<const Hold> hold = {},
            const std::filesystem::path& own = {});
    /// Tries to write the queue first.
    ~Journal();
    Journal(const Journal&) = delete;

    /// Fails if the content is larger than MAX_RECORD_BYTES.
    RecordNumber append(RecordKind kind, std::string label, std::vector<std::byte> content, RecordNumber about = 0);
    /// The number of the last record appended.
    RecordNumber last() const;
    /// Waits until all appended records are on disk; fails with the reason if that is not possible.
    void flush();
    /// Number of the last record on disk; all earlier records are on disk, too.
    RecordNumber durable() const;
    /// Number and checksum of the last durable record; both 0 if there is none.
    std::pair<RecordNumber, uint64_t> last_durable() const;
    /// False if the file was removed or replaced since it was opened: data written to the file will then be
    /// lost.
    bool is_in_place() const;
    /// Whether another process has claimed the journal (Hold::is_kept), as of the last write.
    bool is_claimed() const { return is_claimed_; }
    /// The file's present name, which has changed if the file was renamed within its folder; empty if it has no name.
    std::filesystem::path present_name() const;
    /// Copies the durable part of the journal to another file, atomically.
    void copy_to(const std::filesystem::path& path) const;
    /// Why writing fails at present; empty if writing does not fail.
    std::string failure() const;
    /// Size of the file in bytes, plus the uncompressed size of the queued records.
    uint64_t bytes() const;

    /// The content of a durable record.
    std::vector<std::byte> read(RecordNumber number) const;

private:
    struct Waiting {
        JournalRecord record;
        std::vector<std::byte> bytes;  ///< the content, then the frame
        bool is_framed = false;
    };
    void write();
    /// Frames (and compresses) the queued records that have no frame yet.
    void frame_all(std::deque<Waiting>& waiting);
    /// Returns the reason of a failure; empty on success.
    std::string write_from(uint64_t at, const std::deque<Waiting>& waiting, size_t first) const;
    void begin(const std::filesystem::path& rest, std::span<const std::byte> head);
    void expect_hold(const JournalScan& before) const;
    void put_in_place(const std::filesystem::path& own, const JournalScan& before);
    void remove_new() noexcept;
    bool is_named(const std::filesystem::path& path) const;
    std::string sync_beginning() const;

    std::filesystem::path path_;
    FileDescriptor file_;
    std::shared_ptr<const Hold> hold_;
    std::atomic<bool> is_claimed_ = false;

    mutable std::mutex mutex_;
    std::condition_variable appended_, tried_;
    std::deque<Waiting> queue_;
    std::vector<JournalRecord> records_;  ///< the durable ones
    RecordNumber last_ = 0;               ///< last number appended
    uint64_t end_ = 0;                    ///< end of the durable part
    uint64_t waiting_bytes_ = 0;
    uint64_t tries_ = 0;
    int flushing_ = 0;
    bool is_ending_ = false;
    std::string failure_;

    uint64_t checksum_ = 0;     ///< checksum of the last framed record; used by the journal's thread
    bool is_to_begin_ = false;  ///< header or length may not be on disk yet; used by the journal's thread
    std::thread thread_;
};

/// Appends the first `end` bytes of a journal to `to`. `head`: replaces its first bytes, as in JournalScan.
void copy_bytes(const FileDescriptor& file, const std::filesystem::path& path, uint64_t end,
                std::span<const std::byte> head, AtomicWriter& to);

/// Fails with JournalTaken if another process locks the file, or has written, created or replaced it since it was read.
void expect_as_read(const std::filesystem::path& path, const JournalScan& before);

}  // namespace shvr
