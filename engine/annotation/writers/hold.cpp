#include "engine/annotation/writers/hold.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>
#include <utility>
#include <vector>

#include "engine/annotation/writers/holder_text.h"
#include "engine/annotation/writers/process.h"
#include "engine/annotation/writers/writer_mark.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr size_t MAX_LOCK_BYTES = 4096;
/// Maximum length of a line's value, because messages quote it.
constexpr size_t MAX_PART_BYTES = 120;

struct flock whole_file(short type)
{
    struct flock range {};
    range.l_type = type;
    range.l_whence = SEEK_SET;
    return range;  // from 0 on, without an end
}

enum class Locking { done, taken, impossible };

Locking lock(const FileDescriptor& file)
{
    struct flock range = whole_file(F_WRLCK);
    while (::fcntl(file.number(), F_OFD_SETLK, &range) != 0) {
        if (errno == EINTR) continue;
        return errno == EAGAIN || errno == EACCES ? Locking::taken : Locking::impossible;
    }
    return Locking::done;
}

bool is_locked(const FileDescriptor& file)
{
    struct flock range = whole_file(F_RDLCK);
    return ::fcntl(file.number(), F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
}

/// Whether the open file is still at the path: false if it was removed or replaced.
bool is_at(const FileDescriptor& file, const fs::path& path)
{
    struct stat opened {
    }, named{};
    return ::fstat(file.number(), &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

std::string user_name()
{
    struct passwd entry {};
    struct passwd* found = nullptr;
    std::vector<char> buffer(16384);
    if (::getpwuid_r(::geteuid(), &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr)
        return found->pw_name;
    return sentence(::geteuid());
}

/// Visits the names of the lines of JOURNAL.lock, each with the member that the line sets.
template <class SomeHolder, class Visit>
void each_line(SomeHolder& holder, const Visit& visit)
{
    visit("program", holder.program);
    visit("process", holder.process);
    visit("host", holder.host);
    visit("user", holder.user);
    visit("since", holder.since);
}

Holder this_process(std::string_view program)
{
    return {std::string(program), sentence(::getpid()), host_name(), user_name(), time_in_words(std::time(nullptr))};
}

/// Does not report write errors: only the lock matters, not the content of its file.
void describe(const FileDescriptor& file, const Holder& holder)
{
    const std::string text = to_text(holder);
    if (::ftruncate(file.number(), 0) != 0) return;
    static_cast<void>(::pwrite(file.number(), text.data(), text.size(), 0) > 0);
}

Holder described(const FileDescriptor& file)
{
    std::string text(MAX_LOCK_BYTES, '\0');
    const ssize_t count = ::pread(file.number(), text.data(), text.size(), 0);
    text.resize(count > 0 ? size_t(count) : 0);
    return parse_holder(text);
}

/// Whether the content is empty or of an ended process on this host: the present holder has not written its own yet.
bool is_dated(const Holder& holder)
{
    const std::optional<int64_t> process = whole_of(holder.process);
    if (!process) return true;
    return holder.host == host_name() && ::kill(pid_t(*process), 0) != 0 && errno == ESRCH;
}

Holder holder_in(const FileDescriptor& file)
{
    constexpr int TRIES = 20;
    constexpr std::chrono::milliseconds TURN(5);
    Holder holder = described(file);
    for (int i = 1; i < TRIES && is_dated(holder); ++i) {
        std::this_thread::sleep_for(TURN);
        holder = described(file);
    }
    return holder;
}

[[noreturn]] void refuse(const fs::path& journal, const Holder& holder)
{
    throw JournalTaken(sentence(journal.string(), ": is open for writing in ", in_words(holder),
                                "; expected nobody else to be writing it"));
}

/// Returns false only if the file is certainly missing.
bool is_there(const fs::path& path)
{
    // Opens the file, because on network file systems this asks the server, while stat(2) may use cached data.
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
    return file || errno != ENOENT;
}

FileDescriptor opened(const fs::path& path, int flags)
{
    return FileDescriptor(::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0666));
}

}  // namespace

fs::path lock_path(const fs::path& journal)
{
    fs::path path = journal;
    return path += ".lock";
}

std::string time_in_words(std::time_t time)
{
    std::tm local{};
    char text[32] = {};
    ::localtime_r(&time, &local);
    return std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local) > 0 ? text : "";
}

std::string to_text(const Holder& holder)
{
    std::string text;
    each_line(holder, [&](const char* name, const std::string& value) { text += sentence(name, ": ", value, "\n"); });
    return text;
}

Holder parse_holder(std::string_view text)
{
    Holder holder;
    while (!text.empty()) {
        const std::string_view line = take_line(text);
        each_line(holder, [&](const std::string& name, std::string& value) {
            if (line.starts_with(name + ": ")) value = printable(line.substr(name.size() + 2, MAX_PART_BYTES));
        });
    }
    return holder;
}

std::string in_words(const Holder& holder)
{
    std::string text = holder.program.empty() ? "another program" : holder.program;
    if (!holder.process.empty()) text += ", process " + holder.process;
    if (!holder.host.empty()) text += " on " + holder.host;
    if (!holder.user.empty()) text += " of user " + holder.user;
    if (!holder.since.empty()) text += ", since " + holder.since;
    if (holder.may_have_ended) text += ", if that has not ended";
    return text;
}

namespace {

/// Locks JOURNAL.lock; fails with JournalTaken if another process has locked it. Null if no lock is possible.
std::optional<FileDescriptor> locked(const fs::path& journal)
{
    const fs::path path = lock_path(journal);
    constexpr int TRIES = 100;  // for when other processes release or take the lock between two calls
    for (int i = 0; i < TRIES; ++i) {
        FileDescriptor file = opened(path, O_RDWR | O_CREAT);
        if (!file) {
            // The file may belong to another user, so that it can only be read.
            const FileDescriptor readable = opened(path, O_RDONLY);
            if (!readable) return std::nullopt;
            if (is_locked(readable)) refuse(journal, holder_in(readable));
            if (::unlink(path.c_str()) != 0) return std::nullopt;
            continue;
        }
        const Locking locking = lock(file);
        if (locking == Locking::impossible) {
            ::unlink(path.c_str());
            return std::nullopt;
        }
        if (!is_at(file, path)) continue;
        if (locking == Locking::taken) refuse(journal, holder_in(file));
        return file;
    }
    return std::nullopt;
}

/// The path of the copy of the journal that the mark's owner makes before it replaces the journal with the copy.
fs::path copy_beside(const fs::path& mark)
{
    return fs::path(mark).replace_extension(".copy");
}

}  // namespace

std::shared_ptr<Hold> Hold::take(const fs::path& journal, std::string_view program)
{
    int ignored = 0;
    return take(journal, program, ignored);
}

std::shared_ptr<Hold> Hold::take(const fs::path& journal, std::string_view program, int& error)
{
    error = 0;
    if (journal.empty()) return nullptr;
    std::optional<FileDescriptor> lock = locked(journal);
    constexpr int TRIES = 20;
    constexpr std::chrono::milliseconds TURN(5);
    for (int i = 1;; ++i) {
        const std::optional<fs::path> mark = make_mark(journal, error);
        if (!mark) {
            if (lock && is_at(*lock, lock_path(journal))) ::unlink(lock_path(journal).c_str());
            return nullptr;
        }
        const std::shared_ptr<Hold> hold(new Hold(journal, *mark));
        if (hold->looks_alone(i == TRIES)) {
            const Holder holder = this_process(program);
            describe_mark(*mark, holder);
            if (lock) describe(*lock, holder);
            if (lock) hold->lock_.emplace(std::move(*lock));
            return hold;
        }
        // Two processes that begin at the same moment both back off, for different times.
        std::this_thread::sleep_for(TURN + std::chrono::microseconds(::getpid() % 97 * 50));
    }
}

/// Returns false if another process also tries to take the hold, except on the last try; fails if a process holds it.
bool Hold::looks_alone(bool is_last_try)
{
    std::optional<std::vector<WriterMark>> marks = marks_of(journal_, mark_);
    if (!marks)
        fail(journal_.parent_path().string(), ": cannot be listed; expected so, to see who else is writing there");
    for (WriterMark& mark : *marks) {
        switch (mark.owner) {
            case WriterMark::Owner::running:
                if (!mark.is_described && !is_last_try) return false;
                refuse(journal_, mark.holder);
            case WriterMark::Owner::ended:
                ::unlink(copy_beside(mark.path).c_str());
                ::unlink(mark.path.c_str());
                break;
            case WriterMark::Owner::unknown:
                doubtful_.push_back(std::move(mark.holder));
                doubtful_marks_.push_back(std::move(mark.path));
                break;
        }
    }
    return true;
}

Hold::Hold(fs::path journal, fs::path mark) : journal_(std::move(journal)), mark_(std::move(mark)) {}

Hold::~Hold()
{
    const fs::path path = lock_path(journal_);
    if (lock_ && is_at(*lock_, path)) ::unlink(path.c_str());
    ::unlink(mark_.c_str());
    ::unlink(revoked(mark_).c_str());
}

fs::path Hold::own_name() const
{
    return copy_beside(mark_);
}

bool Hold::is_kept() const
{
    return is_there(mark_);
}

std::optional<Holder> Hold::successor() const
{
    const std::optional<std::vector<WriterMark>> marks = marks_of(journal_, mark_);
    if (!marks) return std::nullopt;
    for (const WriterMark& mark : *marks)
        if (mark.owner != WriterMark::Owner::ended && mark.path != revoked(mark_)) return mark.holder;
    return std::nullopt;
}

bool Hold::claim()
{
    std::vector<fs::path> claimed;
    for (const fs::path& mark : doubtful_marks_) {
        const fs::path name = revoked(mark);
        // A mark is missing if its owner has removed it, because it closed the journal, or if another process has
        // revoked it since it was listed. In the second case the owner may still write.
        const bool is_revoked = name != mark && std::rename(mark.c_str(), name.c_str()) == 0;
        if (!is_revoked && name != mark && errno != ENOENT)
            fail(name.string(), ": cannot be written: ", reason_of(errno));
        if (is_revoked || is_there(name)) claimed.push_back(name);
    }
    doubtful_marks_ = std::move(claimed);
    if (doubtful_marks_.empty()) doubtful_.clear();
    return !doubtful_marks_.empty();
}

void Hold::end_claim()
{
    for (const fs::path& mark : doubtful_marks_) ::unlink(mark.c_str());
    doubtful_marks_.clear();
    doubtful_.clear();
}

std::optional<Holder> holder_of(const fs::path& journal)
{
    if (journal.empty()) return std::nullopt;
    const FileDescriptor file = opened(lock_path(journal), O_RDONLY);
    if (file && is_locked(file)) return holder_in(file);
    const std::optional<std::vector<WriterMark>> marks = marks_of(journal);
    if (!marks) return std::nullopt;
    const auto found = std::ranges::min_element(*marks, {}, &WriterMark::owner);
    if (found == marks->end() || found->owner == WriterMark::Owner::ended) return std::nullopt;
    return found->holder;
}

}  // namespace shvr
