#include "engine/annotation/work/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <utility>

#include "engine/annotation/work/saved_files.h"
#include "engine/annotation/writers/no_replace.h"
#include "engine/base/atomic_writer.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds SYNC_INTERVAL{100};
constexpr std::chrono::seconds RETRY_INTERVAL{1};

/// Returns 0, or errno.
int write_all(int file, uint64_t at, std::span<const std::byte> bytes)
{
    while (!bytes.empty()) {
        const ssize_t count = ::pwrite(file, bytes.data(), bytes.size(), off_t(at));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return errno;
        if (count == 0) return ENOSPC;
        at += uint64_t(count);
        bytes = bytes.subspan(size_t(count));
    }
    return 0;
}

int sync(int file)
{
    while (::fdatasync(file) != 0)
        if (errno != EINTR) return errno;
    return 0;
}

[[noreturn]] void refuse_changed(const fs::path& path, const JournalScan& before)
{
    std::error_code ignored;
    const bool is_dangling = fs::is_symlink(path, ignored) && !fs::exists(path, ignored);
    if (is_dangling) fail(path.string(), ": cannot be written: ", reason_of(ENOENT));
    throw JournalTaken(sentence(path.string(), ": another process has written it since it was read; expected ",
                                before.file_bytes, " bytes: open it again"));
}

/// Opens and locks the file, which must not have changed since it was read. Creates the file if there was none.
FileDescriptor opened(const fs::path& path, const JournalScan& before)
{
    const bool was_there = before.inode != 0;
    const int creating = was_there ? 0 : O_CREAT | O_EXCL;
    FileDescriptor file(::open(path.c_str(), O_RDWR | creating | O_CLOEXEC | O_NONBLOCK, 0666));
    if (!file && errno == (was_there ? ENOENT : EEXIST)) refuse_changed(path, before);
    if (!file) fail(path.string(), ": cannot be written: ", reason_of(errno));
    // Some network file systems have no locks.
    if (::flock(file.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        throw JournalTaken(
            sentence(path.string(), ": another process is annotating this; expected no other: close it there first"));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
    if (uint64_t(status.st_size) != before.file_bytes || (was_there && status.st_ino != before.inode))
        refuse_changed(path, before);
    return file;
}

/// The bytes from `at` to `end`.
void copy(const FileDescriptor& file, const fs::path& path, uint64_t at, uint64_t end, AtomicWriter& to)
{
    std::vector<std::byte> piece(size_t{1} << 20);
    while (at < end) {
        const auto wanted = size_t(std::min<uint64_t>(piece.size(), end - at));
        const ssize_t count = ::pread(file.number(), piece.data(), wanted, off_t(at));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) fail(path.string(), ": cannot be read: ", reason_of(count < 0 ? errno : EIO));
        to.append(std::span(piece).first(size_t(count)));
        at += uint64_t(count);
    }
}

/// The first of the paths .rest1, .rest2, ... that does not exist.
fs::path free_rest(const fs::path& path)
{
    for (int number = 1;; ++number) {
        fs::path rest = path;
        rest += sentence(".rest", number);
        std::error_code ignored;
        if (!fs::exists(fs::symlink_status(rest, ignored))) return rest;
    }
}

}  // namespace

void copy_bytes(const FileDescriptor& file, const fs::path& path, uint64_t end, std::span<const std::byte> head,
                AtomicWriter& to)
{
    const uint64_t known = std::min<uint64_t>(head.size(), end);
    to.append(head.first(size_t(known)));
    copy(file, path, known, end, to);
}

void expect_as_read(const fs::path& path, const JournalScan& before)
{
    if (before.inode != 0)
        static_cast<void>(opened(path, before));
    else if (std::error_code ignored; fs::exists(fs::symlink_status(path, ignored)))
        refuse_changed(path, before);
}

Journal::Journal(const fs::path& path, JournalScan before, std::shared_ptr<const Hold> hold, const fs::path& own)
    : path_(path),
      file_(opened(own.empty() ? path : own, before)),
      hold_(std::move(hold)),
      end_(before.end),
      checksum_(before.checksum())
{
    records_ = std::move(before.records);
    last_ = records_.size();
    try {
        // Checked after opening the file: processes that claim the journal later find this file and do not write it.
        expect_hold(before);
        if (end_ == 0 || end_ < before.file_bytes || !before.head.empty()) begin(free_rest(path), before.head);
        if (!own.empty()) put_in_place(own, before);
    } catch (...) {
        if (!own.empty())
            ::unlink(own.c_str());
        else if (before.inode == 0)
            remove_new();
        throw;
    }
    thread_ = std::thread([this] { write(); });
}

void Journal::expect_hold(const JournalScan& before) const
{
    if (hold_ && !hold_->is_kept()) refuse_changed(path_, before);
}

void Journal::put_in_place(const fs::path& own, const JournalScan& before)
{
    for (;;) {
        expect_hold(before);
        switch (put_at_free(own, path_)) {
            case Renaming::done:
                sync_folder(path_);
                // Checked again, because a process that claimed the journal before this moment did not find this file.
                return expect_hold(before);
            case Renaming::name_taken: static_cast<void>(set_aside(path_)); break;
            case Renaming::gone: fail(own.string(), ": is missing; expected the journal that was just written there");
        }
    }
}

/// Removes the file that this process created at the journal's path, which has no record yet. Another process may have
/// put its own file there meanwhile, so the file at the path is moved first, and removed only if it is this process's.
void Journal::remove_new() noexcept
{
    try {
        if (!is_in_place()) return;
        const std::optional<fs::path> moved = set_aside(path_);
        if (!moved) return;
        if (is_named(*moved))
            ::unlink(moved->c_str());
        else
            static_cast<void>(put_at_free(*moved, path_));
    } catch (const Error&) {
        // This process's empty file stays. If another process's file was moved, its owner moves it back to the path.
    }
}

void Journal::begin(const fs::path& rest, std::span<const std::byte> head)
{
    const auto check = [&](int error) {
        if (error != 0) fail(path_.string(), ": cannot be written: ", reason_of(error));
    };
    struct stat status {};
    check(::fstat(file_.number(), &status) == 0 ? 0 : errno);
    if (const auto bytes = uint64_t(status.st_size); bytes > end_) {
        AtomicWriter writer(rest);
        copy(file_, path_, end_, bytes, writer);
        writer.commit();
        check(::ftruncate(file_.number(), off_t(end_)) == 0 ? 0 : errno);
    }
    check(write_all(file_.number(), 0, head));
    if (end_ == 0) {
        const std::vector<std::byte> header = journal_header();
        check(write_all(file_.number(), 0, header));
        end_ = header.size();
    }
    is_to_begin_ = true;
}

/// Call before any record is written: a journal that lost its header in a power cut must not contain any record
/// (has_file_header in journal_file.cpp). Returns the reason of a failure; empty on success.
std::string Journal::sync_beginning() const
{
    try {
        if (const int error = sync(file_.number()); error != 0)
            fail(path_.string(), ": cannot be synced: ", reason_of(error));
        sync_folder(path_);
    } catch (const Error& error) {
        return sentence(error.what(), "; unsaved work stays in memory, and writing is tried again");
    }
    return {};
}

Journal::~Journal()
{
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    appended_.notify_all();
    thread_.join();
}

RecordNumber Journal::append(RecordKind kind, std::string label, std::vector<std::byte> content, RecordNumber about)
{
    if (content.size() > MAX_RECORD_BYTES)
        fail(label, ": changes so much that its record has ", content.size(), " bytes; expected at most ",
             MAX_RECORD_BYTES);
    const std::scoped_lock lock(mutex_);
    waiting_bytes_ += content.size();
    queue_.push_back(
        {.record = {.kind = kind, .label = std::move(label), .about = about}, .bytes = std::move(content)});
    appended_.notify_all();
    return ++last_;
}

void Journal::flush()
{
    std::unique_lock lock(mutex_);
    const RecordNumber target = last_;
    if (records_.size() >= target) return;
    // The write in progress may have begun before the last record was appended, so wait for the next write, too.
    const uint64_t enough = tries_ + 2;
    ++flushing_;
    appended_.notify_all();
    tried_.wait(lock, [&] { return records_.size() >= target || (tries_ >= enough && !failure_.empty()); });
    --flushing_;
    if (records_.size() < target) fail(failure_);
}

RecordNumber Journal::durable() const
{
    const std::scoped_lock lock(mutex_);
    return records_.size();
}

std::pair<RecordNumber, uint64_t> Journal::last_durable() const
{
    const std::scoped_lock lock(mutex_);
    if (records_.empty()) return {0, 0};
    return {records_.size(), records_.back().checksum};
}

bool Journal::is_in_place() const
{
    struct stat held {
    }, named{};
    if (::fstat(file_.number(), &held) != 0) return true;  // unknown
    if (::stat(path_.c_str(), &named) != 0) return errno != ENOENT;
    return held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

bool Journal::is_named(const fs::path& path) const
{
    struct stat held {
    }, named{};
    return ::fstat(file_.number(), &held) == 0 && ::lstat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
           held.st_dev == named.st_dev;
}

fs::path Journal::present_name() const
{
    if (is_in_place()) return path_;
    const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        if (is_named(entry->path())) return path_.parent_path() / entry->path().filename();
    return {};
}

void Journal::copy_to(const fs::path& path) const
{
    std::unique_lock lock(mutex_);
    const uint64_t end = end_;
    lock.unlock();
    AtomicWriter writer(path);
    copy(file_, path_, 0, end, writer);
    writer.commit();
}

std::string Journal::failure() const
{
    const std::scoped_lock lock(mutex_);
    return failure_;
}

uint64_t Journal::bytes() const
{
    const std::scoped_lock lock(mutex_);
    return end_ + waiting_bytes_;
}

RecordNumber Journal::last() const
{
    const std::scoped_lock lock(mutex_);
    return last_;
}

std::vector<std::byte> Journal::read(RecordNumber number) const
{
    std::unique_lock lock(mutex_);
    SHVR_CHECK(number >= 1 && number <= records_.size(), number);
    const JournalRecord record = records_[number - 1];
    lock.unlock();
    return content_of(record, file_, path_);
}

void Journal::frame_all(std::deque<Waiting>& waiting)
{
    for (Waiting& one : waiting) {
        if (std::exchange(one.is_framed, true)) continue;
        one.bytes = framed(one.record, one.bytes, checksum_);
    }
}

std::string Journal::write_from(uint64_t at, const std::deque<Waiting>& waiting, size_t first) const
{
    for (; first < waiting.size(); ++first) {
        if (const int error = write_all(file_.number(), at, waiting[first].bytes); error != 0)
            return sentence(path_.string(), ": cannot be written: ", reason_of(error),
                            "; unsaved work stays in memory, and writing is tried again");
        at += waiting[first].bytes.size();
    }
    return {};
}

void Journal::write()
{
    std::deque<Waiting> waiting;  // not yet synced
    size_t written = 0;           // how many of these have been written
    uint64_t written_bytes = 0;
    Clock::time_point next_sync = Clock::now(), next_try = next_sync;
    std::unique_lock lock(mutex_);
    for (;;) {
        const auto is_asked = [&] { return !queue_.empty() || is_ending_ || flushing_ > 0; };
        if (waiting.empty())
            appended_.wait(lock, [&] { return !queue_.empty() || is_ending_; });
        else if (!failure_.empty())
            appended_.wait_until(lock, next_try, [&] { return is_ending_ || flushing_ > 0; });
        else
            appended_.wait_until(lock, next_sync, is_asked);
        const bool is_last = is_ending_, is_due = flushing_ > 0 || is_ending_ || Clock::now() >= next_sync;
        for (Waiting& one : queue_) waiting.push_back(std::move(one));
        queue_.clear();
        const uint64_t begin = end_;
        lock.unlock();

        frame_all(waiting);
        std::string failure = is_to_begin_ ? sync_beginning() : std::string();
        if (failure.empty()) is_to_begin_ = false;
        if (failure.empty()) failure = write_from(begin + written_bytes, waiting, written);
        if (failure.empty()) {
            for (; written < waiting.size(); ++written) written_bytes += waiting[written].bytes.size();
            if (is_due && written > 0) {
                if (const int error = sync(file_.number()); error != 0)
                    failure = sentence(path_.string(), ": cannot be synced: ", reason_of(error),
                                       "; unsaved work stays in memory, and writing is tried again");
                next_sync = Clock::now() + SYNC_INTERVAL;
                if (hold_ && !hold_->is_kept()) is_claimed_ = true;
            }
        }
        if (!failure.empty()) {
            // Truncates, because readers would stop at a partial record, and unsynced data may not be on disk at all.
            static_cast<void>(::ftruncate(file_.number(), off_t(begin)) == 0);
            written = 0;
            written_bytes = 0;
            next_try = Clock::now() + RETRY_INTERVAL;
        }

        lock.lock();
        failure_ = failure;
        if (failure.empty() && is_due) {
            for (Waiting& one : waiting) {
                waiting_bytes_ -= one.record.bytes;
                one.record.content_at = end_ + one.bytes.size() - one.record.stored_bytes;
                end_ += one.bytes.size();
                records_.push_back(std::move(one.record));
            }
            waiting.clear();
            written = 0;
            written_bytes = 0;
        }
        ++tries_;
        tried_.notify_all();
        if (is_last) return;
    }
}

}  // namespace shvr
