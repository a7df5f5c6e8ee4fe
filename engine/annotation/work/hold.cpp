#include "engine/annotation/work/hold.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <thread>
#include <utility>
#include <vector>

#include "engine/annotation/work/holder_text.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr size_t MAX_LOCK_BYTES = 4096;
/// Maximum length of one part, since messages quote it.
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

/// False if the file was removed or replaced since it was opened.
bool is_at(const FileDescriptor& file, const fs::path& path)
{
    struct stat opened {
    }, named{};
    return ::fstat(file.number(), &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

std::string host_name()
{
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
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

std::string time_now()
{
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    char text[32] = {};
    ::localtime_r(&now, &local);
    return std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local) > 0 ? text : "";
}

/// Visits the lines of JOURNAL.lock and the members that they set.
template <class SomeHolder, class Visit>
void each_line(SomeHolder& holder, const Visit& visit)
{
    visit("program", holder.program);
    visit("process", holder.process);
    visit("host", holder.host);
    visit("user", holder.user);
    visit("since", holder.since);
}

/// Write errors are not reported: the lock matters, not the content of its file.
void describe(const FileDescriptor& file, std::string_view program)
{
    const std::string text =
        to_text({std::string(program), sentence(::getpid()), host_name(), user_name(), time_now()});
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

/// Returns whether a dead process of this host left the file's content: the present holder has yet to write its own.
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

[[noreturn]] void refuse(const fs::path& journal, const FileDescriptor& file)
{
    throw JournalTaken(sentence(journal.string(), ": is open for writing in ", in_words(holder_in(file)),
                                "; expected nobody else to be writing it"));
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
    return text;
}

std::shared_ptr<Hold> Hold::take(const fs::path& journal, std::string_view program)
{
    if (journal.empty()) return nullptr;
    const fs::path path = lock_path(journal);
    constexpr int TRIES = 100;  // number of retries after another process released or took the lock between two calls
    for (int i = 0; i < TRIES; ++i) {
        FileDescriptor file = opened(path, O_RDWR | O_CREAT);
        if (!file) {
            // Another user's file, which can only be read.
            const FileDescriptor readable = opened(path, O_RDONLY);
            if (!readable) return nullptr;
            if (is_locked(readable)) refuse(journal, readable);
            if (::unlink(path.c_str()) != 0) return nullptr;
            continue;
        }
        const Locking locking = lock(file);
        if (locking == Locking::impossible) {
            ::unlink(path.c_str());
            return nullptr;
        }
        if (!is_at(file, path)) continue;
        if (locking == Locking::taken) refuse(journal, file);
        describe(file, program);
        return std::shared_ptr<Hold>(new Hold(journal, std::move(file)));
    }
    return nullptr;
}

Hold::Hold(fs::path journal, FileDescriptor file) : journal_(std::move(journal)), file_(std::move(file)) {}

Hold::~Hold()
{
    const fs::path path = lock_path(journal_);
    if (is_at(file_, path)) ::unlink(path.c_str());
}

std::optional<Holder> holder_of(const fs::path& journal)
{
    if (journal.empty()) return std::nullopt;
    const FileDescriptor file = opened(lock_path(journal), O_RDONLY);
    if (!file || !is_locked(file)) return std::nullopt;
    return holder_in(file);
}

}  // namespace shvr
