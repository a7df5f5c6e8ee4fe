#include "engine/remote/object_cache.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <span>
#include <utility>

#include "engine/base/assets.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

/// The first bytes of a file. The last digit is the version of the format.
constexpr std::array<char, 8> MAGIC{'S', 'H', 'V', 'R', 'O', 'B', 'J', '1'};
constexpr int64_t MAX_TEXT_BYTES = int64_t{64} << 10;
constexpr int64_t STANDARD_MIB = 4096, MAX_MIB = int64_t{1} << 24;
constexpr const char* TEMPORARY = ".tmp";
/// Temporary files of this age are considered left over from killed processes, and removed.
constexpr auto STALE = std::chrono::hours(1);

/// The header of a file. The object's name, its ETag and its bytes follow, in this order.
struct Head {
    std::array<char, 8> magic;
    uint64_t checksum;  ///< of everything in the file after this member
    int64_t object_bytes, bytes;
    uint32_t name_bytes, etag_bytes;
    uint32_t is_missing, unused;
};
static_assert(sizeof(Head) == 48);

constexpr size_t CHECKED_FROM = offsetof(Head, object_bytes);

uint64_t checksum_of(std::span<const std::byte> content)
{
    return XXH3_64bits(content.data() + CHECKED_FROM, content.size() - CHECKED_FROM);
}

std::vector<std::byte> content_of(const std::string& name, const CachedObject& object)
{
    Head head{.magic = MAGIC,
              .checksum = 0,
              .object_bytes = object.object_bytes,
              .bytes = int64_t(object.bytes.size()),
              .name_bytes = uint32_t(name.size()),
              .etag_bytes = uint32_t(object.etag.size()),
              .is_missing = object.is_missing,
              .unused = 0};
    std::vector<std::byte> content(sizeof(Head) + name.size() + object.etag.size() + object.bytes.size());
    std::byte* to = content.data() + sizeof(Head);
    const auto put = [&](const auto& text) {
        if (!text.empty()) std::memcpy(to, text.data(), text.size());
        to += text.size();
    };
    put(name);
    put(object.etag);
    put(object.bytes);
    std::memcpy(content.data(), &head, sizeof(Head));
    head.checksum = checksum_of(content);
    std::memcpy(content.data(), &head, sizeof(Head));
    return content;
}

/// Returns null if the content is damaged or belongs to an object with another name.
std::optional<CachedObject> object_of(std::span<const std::byte> content, const std::string& name)
{
    Head head{};
    if (content.size() < sizeof(Head)) return std::nullopt;
    std::memcpy(&head, content.data(), sizeof(Head));
    if (head.magic != MAGIC || head.checksum != checksum_of(content)) return std::nullopt;
    const auto rest = int64_t(content.size() - sizeof(Head));
    if (head.bytes < 0 || head.bytes > rest || int64_t{head.name_bytes} + head.etag_bytes != rest - head.bytes)
        return std::nullopt;
    const auto* const text = reinterpret_cast<const char*>(content.data() + sizeof(Head));
    if (std::string_view(text, head.name_bytes) != name) return std::nullopt;
    const auto bytes = content.last(size_t(head.bytes));
    return CachedObject{.is_missing = head.is_missing != 0,
                        .etag = std::string(text + head.name_bytes, head.etag_bytes),
                        .object_bytes = head.object_bytes,
                        .bytes = {bytes.begin(), bytes.end()}};
}

bool write_all(int file, std::span<const std::byte> content)
{
    while (!content.empty()) {
        const ssize_t count = ::write(file, content.data(), content.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        content = content.subspan(size_t(count));
    }
    return true;
}

struct KeptFile {
    fs::path path;
    int64_t bytes;
    timespec used;
};

/// Returns the files of the cache, least recently used first. Skips temporary files, and removes those that are stale.
std::vector<KeptFile> files_in(const fs::path& folder)
{
    std::vector<KeptFile> files;
    std::error_code ignored;
    const auto now = fs::file_time_type::clock::now();
    for (fs::recursive_directory_iterator entry(folder, ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
        struct stat status {};
        if (::lstat(entry->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
        std::error_code unknown;
        const std::string name = entry->path().filename().string();
        if (name.find(TEMPORARY) != std::string::npos) {
            if (now - fs::last_write_time(entry->path(), unknown) > STALE && !unknown)
                fs::remove(entry->path(), unknown);
        } else if (name.size() == 32) {
            files.push_back({entry->path(), int64_t(status.st_size), status.st_mtim});
        }
    }
    std::ranges::sort(files, {}, [](const KeptFile& file) { return std::pair(file.used.tv_sec, file.used.tv_nsec); });
    return files;
}

}  // namespace

ObjectCache::ObjectCache(fs::path folder, int64_t budget_bytes)
    // Counts a full budget as unchecked, so that the first `keep` measures what other processes have stored.
    : folder_(std::move(folder)), budget_bytes_(folder_.empty() ? 0 : budget_bytes), unchecked_bytes_(budget_bytes)
{}

fs::path ObjectCache::path_of(const std::string& name) const
{
    const XXH128_hash_t hash = XXH3_128bits(name.data(), name.size());
    constexpr std::string_view DIGITS = "0123456789abcdef";
    std::string digits;
    for (const uint64_t half : {hash.high64, hash.low64})
        for (int shift = 60; shift >= 0; shift -= 4) digits += DIGITS[half >> shift & 15];
    return folder_ / digits.substr(0, 2) / digits;
}

std::optional<CachedObject> ObjectCache::find(const std::string& name, int64_t max_bytes) const
{
    if (budget_bytes_ <= 0) return std::nullopt;
    const fs::path path = path_of(name);
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return std::nullopt;
    try {
        std::optional<CachedObject> object = object_of(read_file(path, max_bytes + 2 * MAX_TEXT_BYTES), name);
        if (!object || int64_t(object->bytes.size()) > max_bytes) {
            fs::remove(path, ignored);
            return std::nullopt;
        }
        static_cast<void>(::utimensat(AT_FDCWD, path.c_str(), nullptr, 0));  // used now
        return object;
    } catch (const Error&) {
        return std::nullopt;  // removed meanwhile, or unreadable
    }
}

void ObjectCache::keep(const std::string& name, const CachedObject& object) const
{
    const auto bytes = int64_t(object.bytes.size());
    if (budget_bytes_ <= 0 || bytes > budget_bytes_ / 4) return;
    if (int64_t(name.size()) > MAX_TEXT_BYTES || int64_t(object.etag.size()) > MAX_TEXT_BYTES) return;
    const fs::path path = path_of(name);
    std::error_code failed;
    fs::create_directories(path.parent_path(), failed);
    if (failed) return;
    // The folder is private, since other users must not read objects that needed a credential.
    static_cast<void>(::chmod(folder_.c_str(), S_IRWXU));
    const std::vector<std::byte> content = content_of(name, object);
    const std::string temporary = path.string() + TEMPORARY + sentence(::getpid(), "-", written_++);
    {
        const FileDescriptor file(
            ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
        if (!file) return;
        if (!write_all(file.number(), content)) {
            fs::remove(temporary, failed);
            return;
        }
    }
    fs::rename(temporary, path, failed);
    if (failed) {
        fs::remove(temporary, failed);
        return;
    }
    unchecked_bytes_ += int64_t(content.size());
    if (unchecked_bytes_ > budget_bytes_ / 16) make_room();
}

void ObjectCache::make_room() const
{
    if (budget_bytes_ <= 0) return;
    unchecked_bytes_ = 0;
    const FileDescriptor lock(::open((folder_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR));
    if (!lock || ::flock(lock.number(), LOCK_EX | LOCK_NB) != 0) return;
    const std::vector<KeptFile> files = files_in(folder_);
    int64_t total = 0;
    for (const KeptFile& file : files) total += file.bytes;
    if (total <= budget_bytes_) return;
    for (const KeptFile& file : files) {
        if (total <= budget_bytes_ / 10 * 9) break;
        std::error_code failed;
        if (fs::remove(file.path, failed)) total -= file.bytes;
    }
}

const ObjectCache& object_cache()
{
    const auto make = [] {
        int64_t mebibytes = STANDARD_MIB;
        if (const char* const text = std::getenv("SHVR_REMOTE_CACHE_MIB"); text != nullptr && *text != '\0') {
            const std::optional<int64_t> stated = whole_of(text);
            if (!stated || *stated < 0 || *stated > MAX_MIB)
                fail("environment variable SHVR_REMOTE_CACHE_MIB is ", in_quotes(text), "; expected 0 to ", MAX_MIB);
            mebibytes = *stated;
        }
        const char* const place = std::getenv("SHVR_REMOTE_CACHE");
        const fs::path user = cache_folder();
        const fs::path folder = place != nullptr && *place != '\0' ? fs::path(place)
                                : user.empty()                     ? fs::path()
                                                                   : user / "remote";
        return std::pair(folder, mebibytes << 20);
    };
    static const std::pair<fs::path, int64_t> where = make();
    static const ObjectCache cache(where.first, where.second);
    return cache;
}

}  // namespace shvr
