#include "engine/base/atomic_writer.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

/// Returns the permissions of the file that will be replaced; null if there is no such file.
std::optional<mode_t> permissions_of_old_file(const fs::path& path)
{
    if (!path.has_filename()) fail("'", path.string(), "': cannot be written; expected the name of a file");
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) {
        if (errno == ENOENT) return {};
        fail(path.string(), ": cannot be written: ", reason_of(errno));
    }
    if (S_ISLNK(status.st_mode)) return {};
    if (S_ISDIR(status.st_mode)) fail(path.string(), ": cannot be written: ", reason_of(EISDIR));
    if (!S_ISREG(status.st_mode)) fail(path.string(), ": is a device, pipe or socket; expected a file or nothing");
    return status.st_mode & 07777;
}

/// Names of temporary files, for signal handlers to remove. If all slots are taken, further files are not removed.
std::array<std::atomic<const char*>, 64> temporary_names{};
static_assert(std::atomic<const char*>::is_always_lock_free);

std::atomic<const char*>* list(const char* name)
{
    for (std::atomic<const char*>& place : temporary_names) {
        const char* none = nullptr;
        if (place.compare_exchange_strong(none, name)) return &place;
    }
    return nullptr;
}

constexpr std::string_view PREFIX = ".shvr-", SUFFIX = ".tmp";
constexpr std::chrono::hours FOREIGN_AGE{24};
/// A long append syncs after every BYTES_PER_SYNC bytes, so that the final, uninterruptible sync does not take long.
constexpr uint64_t BYTES_PER_SYNC = uint64_t{64} << 20;

/// Returns the host's name with only those characters that are safe in a file name.
std::string host_of_names()
{
    char name[256] = {};
    if (::gethostname(name, sizeof name - 1) != 0) return "host";
    std::string safe;
    for (const char character : std::string_view(name).substr(0, 64)) {
        const bool is_safe = is_digit(character) || (character >= 'a' && character <= 'z') ||
                             (character >= 'A' && character <= 'Z') || character == '.';
        safe += is_safe ? character : '_';
    }
    return safe.empty() ? "host" : safe;
}

/// Process and host stated in a temporary file's name, ".shvr-PID-N-HOST.tmp". Names by earlier versions lack the host.
struct Owner {
    pid_t process = 0;
    std::string host{};  ///< empty: not stated
};
std::optional<Owner> owner_of(std::string_view name)
{
    if (!name.starts_with(PREFIX) || !name.ends_with(SUFFIX)) return std::nullopt;
    name.remove_prefix(PREFIX.size());
    name.remove_suffix(SUFFIX.size());
    const size_t first = name.find('-');
    if (first == std::string_view::npos) return std::nullopt;
    const size_t second = std::min(name.find('-', first + 1), name.size());
    const std::optional<int64_t> process = whole_of(name.substr(0, first));
    const std::optional<int64_t> number = whole_of(name.substr(first + 1, second - first - 1));
    if (!process || !number || *process < 1 || *process > std::numeric_limits<pid_t>::max()) return std::nullopt;
    return Owner{pid_t(*process), std::string(name.substr(std::min(second + 1, name.size())))};
}

bool is_dead(pid_t process)
{
    return ::kill(process, 0) != 0 && errno == ESRCH;
}

/// Whether a file was left behind: its process is dead or, if this host cannot determine that, the file is old.
bool is_left(const Owner& owner, const fs::directory_entry& entry)
{
    std::error_code error;
    const fs::file_time_type written = entry.last_write_time(error);
    if (error || !entry.is_regular_file(error) || error) return false;
    const bool is_old = fs::file_time_type::clock::now() - written > FOREIGN_AGE;
    if (owner.host == host_of_names()) return is_dead(owner.process);
    return is_old && (!owner.host.empty() || is_dead(owner.process));
}

}  // namespace

fs::path link_target(const fs::path& path)
{
    constexpr int MAX_LINKS = 40;  // as in Linux
    fs::path target = fs::absolute(path).lexically_normal();
    std::error_code ignored;
    for (int links = 0; links < MAX_LINKS && fs::is_symlink(target, ignored); ++links) {
        const fs::path next = fs::read_symlink(target, ignored);
        target = fs::weakly_canonical(target.parent_path(), ignored) / next;
    }
    const fs::path folder = fs::weakly_canonical(target.parent_path(), ignored);
    return ignored ? target : folder / target.filename();
}

void collect_temporary_files(const fs::path& folder)
{
    std::error_code error;
    for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error);
         !error && entry != fs::directory_iterator(); entry.increment(error)) {
        const std::optional<Owner> owner = owner_of(entry->path().filename().string());
        if (owner && is_left(*owner, *entry)) ::unlink(entry->path().c_str());
    }
}

std::optional<int64_t> multiplied(int64_t a, int64_t b)
{
    int64_t product = 0;
    return __builtin_mul_overflow(a, b, &product) ? std::nullopt : std::optional(product);
}

void expect_space(const fs::path& path, std::optional<int64_t> bytes, const char* remedy)
{
    struct statvfs status {};
    const fs::path folder = fs::absolute(link_target(path)).parent_path();
    if (::statvfs(folder.c_str(), &status) != 0 || status.f_blocks == 0) return;
    const auto free = multiplied(int64_t(status.f_bavail), int64_t(status.f_frsize));
    if (!free || (bytes && *bytes <= *free)) return;
    fail(path.string(), ": would take ", bytes ? std::to_string(*bytes) : std::string("more than 2^63 - 1"),
         " bytes; expected at most ", *free, ", the free space of its disk: ", remedy);
}

void remove_temporary_files()
{
    for (std::atomic<const char*>& place : temporary_names)
        if (const char* const name = place.exchange(nullptr)) ::unlink(name);
}

void sync_folder(const fs::path& path)
{
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const FileDescriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    bool is_synced = descriptor && ::fsync(descriptor.number()) == 0;
    while (!is_synced && descriptor && errno == EINTR) is_synced = ::fsync(descriptor.number()) == 0;
    // EINVAL: the file system cannot sync folders. EACCES: we may write to the folder, but not open it for reading.
    if (!is_synced && errno != EINVAL && errno != EACCES) {
        fail(path.string(),
             ": is written, but a power cut could lose it; its folder cannot be synced: ", reason_of(errno));
    }
}

AtomicWriter::AtomicWriter(const fs::path& path)
    : target_(path), old_permissions_(permissions_of_old_file(path)), descriptor_(create())
{}

AtomicWriter::~AtomicWriter()
{
    // Unlisted last, so that a signal never leaves the file behind.
    if (!is_renamed_) ::unlink(temporary_.c_str());
    if (listed_) *listed_ = nullptr;
}

void AtomicWriter::append(std::span<const std::byte> content)
{
    while (!content.empty()) {
        const ssize_t count = ::write(descriptor_.number(), content.data(), content.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) refuse(errno);
        // Some network file systems report a full disk as a write of 0 bytes.
        if (count == 0) refuse(ENOSPC);
        content = content.subspan(size_t(count));
        unsynced_bytes_ += uint64_t(count);
        if (unsynced_bytes_ < BYTES_PER_SYNC) continue;
        unsynced_bytes_ = 0;
        if (::fdatasync(descriptor_.number()) != 0 && errno != EINTR) refuse(errno);
    }
}

void AtomicWriter::write_at(int64_t offset, std::span<const std::byte> content)
{
    while (!content.empty()) {
        const ssize_t count = ::pwrite(descriptor_.number(), content.data(), content.size(), offset);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) refuse(count < 0 ? errno : ENOSPC);
        content = content.subspan(size_t(count));
        offset += count;
    }
}

void AtomicWriter::read_back(int64_t offset, std::span<std::byte> content) const
{
    while (!content.empty()) {
        const ssize_t count = ::pread(descriptor_.number(), content.data(), content.size(), offset);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) refuse(count < 0 ? errno : EIO);
        content = content.subspan(size_t(count));
        offset += count;
    }
}

void AtomicWriter::commit()
{
    // File systems without permissions refuse fchmod (EPERM, ENOTSUP); there are then no permissions to preserve.
    if (old_permissions_ && ::fchmod(descriptor_.number(), *old_permissions_) != 0 && errno != EPERM &&
        errno != ENOTSUP) {
        refuse(errno);
    }
    while (::fsync(descriptor_.number()) != 0) {
        if (errno != EINTR) refuse(errno);
    }
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) refuse(errno);
    is_renamed_ = true;
    if (listed_) *std::exchange(listed_, nullptr) = nullptr;
    sync_folder(target_);
}

FileDescriptor AtomicWriter::create()
{
    // The name does not contain the target's, which may have the maximum length already. An existing file of that name
    // was left by a dead process with our process id.
    static std::atomic<unsigned> count = 0;
    while (true) {
        temporary_ = target_.parent_path() / sentence(PREFIX, ::getpid(), "-", count++, "-", host_of_names(), SUFFIX);
        // Listed before the file exists, so that a signal right after its creation removes it.
        listed_ = list(temporary_.c_str());
        FileDescriptor descriptor(::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
        if (descriptor) return descriptor;
        const int error_number = errno;
        if (listed_) *std::exchange(listed_, nullptr) = nullptr;
        if (error_number != EEXIST && error_number != EINTR) refuse(error_number);
    }
}

void AtomicWriter::refuse(int error_number) const
{
    fail(target_.string(), ": cannot be written: ", reason_of(error_number));
}

}  // namespace shvr
