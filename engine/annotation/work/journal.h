#pragma once
// The journal: every command of the user, appended to a file as it happens. The journal's thread writes at once (a
// killed program loses the last milliseconds) and syncs at most every 100 ms (a power cut loses no more than that and
// the duration of a disk write).
//
//   append (main thread, never waits) -> queue -> frame, write, sync (the journal's thread) -> durable
//
// While writing fails, nothing is lost and no caller waits: records stay in memory, `failure` states the reason, and
// writing is retried every second. Only one process writes a journal: the one that holds it (hold.h), which also locks
// the file itself, for older programs. An existing file is written only by the process that held the journal before and
// after it opened the file; a new one is created exclusively, or under a name that only this process uses.
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
    /// Continues after the valid prefix in `before`: keeps any data after it as JOURNAL.rest1, .rest2 and so on, and
    /// repairs a damaged head. Fails if the file cannot be created or written; fails with JournalTaken if another
    /// process holds it. `hold`: null if no other process knows the journal. `own`: a file name that only this process
    /// uses; `before` then describes that file (or none). It replaces any file at `path`, which is renamed.
    Journal(const std::filesystem::path& path, JournalScan before, std::shared_ptr<const Hold> hold = {},
            const std::filesystem::path& own = {});
    /// Tries to write the queue first.
    ~Journal();
    Journal(const Journal&) = delete;

    /// Fails if the content is larger than MAX_RECORD_BYTES.
    RecordNumber append(RecordKind kind, std::string label, std::vector<std::byte> content, RecordNumber about = 0);
    /// The number of the last record appended.
    RecordNumber last() const;
    /// Waits until everything appended is on disk; fails with the reason if that is not possible.
    void flush();
    /// The number of the last record on disk; all records before it are on disk as well.
    RecordNumber durable() const;
    /// Number and checksum of the last durable record; 0, 0 if there is none.
    std::pair<RecordNumber, uint64_t> last_durable() const;
    /// False if the file was removed or replaced since it was
    /// opened: data written to it will be lost.
    bool is_in_place() const;
    /// Whether another process claimed the journal (Hold::is_kept), as noticed after the last write.
    bool is_claimed() const { return is_claimed_; }
    /// The file's present name, which differs if the file was renamed in its folder; empty if it has no name any more.
    std::filesystem::path present_name() const;
    /// Copies the part of the journal that is on disk to another file, atomically.
    void copy_to(const std::filesystem::path& path) const;
    /// Why writing fails at present; empty if it does not.
    std::string failure() const;
    /// Size of the file in bytes, plus the uncompressed size of the queue.
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
    /// Frames the queued records that have no frame yet.
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
    bool is_to_begin_ = false;  ///< header or length may still be missing on disk; used by the journal's thread
    std::thread thread_;
};

/// Appends the first `end` bytes of a journal to `to`; `head`: as in JournalScan.
void copy_bytes(const FileDescriptor& file, const std::filesystem::path& path, uint64_t end,
                std::span<const std::byte> head, AtomicWriter& to);

/// Fails with JournalTaken if another process locks the file, or wrote, created or replaced it since it was read.
void expect_as_read(const std::filesystem::path& path, const JournalScan& before);

}  // namespace shvr
