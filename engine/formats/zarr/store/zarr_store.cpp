#include "engine/formats/zarr/store/zarr_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/store/chunk_cache.h"
#include "engine/formats/zarr/store/remote_store.h"
#include "engine/formats/zip/zip_archive.h"
#include "engine/remote/address.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using StoredValue = std::vector<std::byte>;

class FolderStore final : public ZarrStore {
public:
    explicit FolderStore(fs::path folder) : folder_(std::move(folder)) {}

    fs::path path_of(const std::string& key) const override { return key.empty() ? folder_ : folder_ / key; }

    std::optional<int64_t> size_of(const std::string& key) const override
    {
        const fs::path path = path_of(key);
        struct stat status {};
        if (::stat(path.c_str(), &status) == 0) return int64_t(status.st_size);
        if (errno == ENOENT) return std::nullopt;
        fail(path.string(), ": cannot be examined: ", reason_of(errno));
    }

    std::optional<StoredValue> read(const std::string& key, int64_t max_bytes) const override
    {
        if (!size_of(key)) return std::nullopt;
        return read_file(path_of(key), max_bytes);
    }

    void read_part(const std::string& key, int64_t offset, std::span<std::byte> part) const override
    {
        const fs::path path = path_of(key);
        const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
        if (!file) fail(path.string(), ": cannot be opened: ", reason_of(errno));
        while (!part.empty()) {
            const ssize_t count = ::pread(file.number(), part.data(), part.size(), off_t(offset));
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
            if (count == 0) fail(path.string(), ": ends at byte ", offset, "; expected ", part.size(), " bytes more");
            part = part.subspan(size_t(count));
            offset += count;
        }
    }

    bool list(const std::string& prefix, const std::function<bool(std::string_view)>& take) const override
    {
        return list_folder(path_of(prefix), "", MAX_FOLDERS, take);
    }

private:
    /// Maximum depth of folders: an array has up to one folder level per axis, and links may form a cycle.
    static constexpr int MAX_FOLDERS = 20;

    /// Lists a folder's keys. Skips hidden names, which are temporary files or metadata of version 2.
    static bool list_folder(const fs::path& folder, const std::string& before, int folders,
                            const std::function<bool(std::string_view)>& take)
    {
        std::error_code error;
        fs::directory_iterator entries(folder, error);
        if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) return true;
        for (const fs::directory_iterator end; !error && entries != end; entries.increment(error)) {
            const std::string name = entries->path().filename().string();
            if (name.starts_with('.')) continue;
            std::error_code ignored;
            const bool is_folder = folders > 0 && entries->is_directory(ignored);
            const bool goes_on =
                is_folder ? list_folder(entries->path(), before + name + "/", folders - 1, take) : take(before + name);
            if (!goes_on) return false;
        }
        if (error) fail(folder.string(), ": its chunks cannot be listed: ", error.message());
        return true;
    }

    fs::path folder_;
};

/// Size of a cache for deflated entries that are read in parts, such as shards that were compressed again when zipped.
/// A deflated entry can only be decoded as a whole, so the most recent ones are cached.
constexpr int64_t KEPT_ENTRY_BYTES = int64_t{64} << 20;
constexpr int64_t MAX_DEFLATED_SHARD_BYTES = int64_t{256} << 20;

class ArchiveStore final : public ZarrStore {
public:
    explicit ArchiveStore(const fs::path& path) : archive_(path), kept_(KEPT_ENTRY_BYTES) {}

    fs::path path_of(const std::string& key) const override
    {
        return key.empty() ? archive_.path() : archive_.path() / key;
    }

    std::optional<int64_t> size_of(const std::string& key) const override
    {
        const ZipEntry* const entry = archive_.find(key);
        if (entry == nullptr) return std::nullopt;
        if (entry->bytes > uint64_t{1} << 62)
            fail(path_of(key).string(), ": holds ", entry->bytes,
                 " bytes by the archive's directory; expected at most 2^62");
        return int64_t(entry->bytes);
    }

    std::optional<StoredValue> read(const std::string& key, int64_t max_bytes) const override
    {
        const ZipEntry* const entry = archive_.find(key);
        if (entry == nullptr) return std::nullopt;
        return archive_.read(*entry, max_bytes);
    }

    void read_part(const std::string& key, int64_t offset, std::span<std::byte> part) const override
    {
        const ZipEntry* const entry = archive_.find(key);
        const int64_t bytes = size_of(key).value_or(0);
        if (entry == nullptr || offset < 0 || offset > bytes || int64_t(part.size()) > bytes - offset) {
            fail(path_of(key).string(), ": holds ", bytes, " bytes; expected ", part.size(), " from byte ", offset,
                 " on");
        }
        if (ZipArchive::is_plain(*entry)) return archive_.read_part(*entry, offset, part);
        const auto whole = kept_.get({0, entry - archive_.entries().data()},
                                     [&] { return archive_.read(*entry, MAX_DEFLATED_SHARD_BYTES); });
        if (!part.empty()) std::memcpy(part.data(), whole->data() + offset, part.size());
    }

    bool list(const std::string& prefix, const std::function<bool(std::string_view)>& take) const override
    {
        const std::vector<ZipEntry>& entries = archive_.entries();
        for (auto entry = std::ranges::lower_bound(entries, std::string_view(prefix), {}, &ZipEntry::name);
             entry != entries.end() && entry->name.starts_with(prefix); ++entry) {
            if (!take(entry->name.substr(prefix.size()))) return false;
        }
        return true;
    }

private:
    ZipArchive archive_;
    mutable ChunkCache kept_;
};

bool is_archive_name(const fs::path& path)
{
    const std::string extension = lower_case(path.extension().string());
    return extension == ".ozx" || extension == ".zip";
}

struct PathIntoArchive {
    fs::path archive;
    fs::path inside;  ///< empty: its root
};

/// Splits a path into the path of an archive and the path inside it; null if the path leads into no archive.
std::optional<PathIntoArchive> split(const fs::path& path)
{
    PathIntoArchive found{path, {}};
    std::error_code ignored;
    while (!fs::exists(found.archive, ignored)) {
        const fs::path parent = found.archive.parent_path();
        if (parent.empty() || parent == found.archive) return std::nullopt;
        if (found.archive.has_filename()) found.inside = found.archive.filename() / found.inside;
        found.archive = parent;
    }
    if (!is_archive_name(found.archive) || !fs::is_regular_file(found.archive, ignored)) return std::nullopt;
    return found;
}

}  // namespace

std::optional<ZarrStore::Edge> ZarrStore::read_edge(const std::string& key, bool is_end, int64_t bytes) const
{
    const std::optional<int64_t> value_bytes = size_of(key);
    if (!value_bytes) return std::nullopt;
    Edge edge{.value_bytes = *value_bytes};
    if (*value_bytes < bytes) return edge;
    edge.bytes.resize(size_t(bytes));
    read_part(key, is_end ? *value_bytes - bytes : 0, edge.bytes);
    return edge;
}

bool ZarrStore::has(const std::string& key) const
{
    try {
        return size_of(key).has_value();
    } catch (const Error&) {
        return false;
    }
}

bool ZarrStore::lacks(const std::string& key) const
{
    try {
        return !size_of(key).has_value();
    } catch (const Error&) {
        return false;
    }
}

fs::path ZarrPlace::path_of(const std::string& name) const
{
    // Without a trailing slash.
    return store->path_of(name.empty() && !prefix.empty() ? prefix.substr(0, prefix.size() - 1) : key(name));
}

ZarrPlace ZarrPlace::operator/(const fs::path& path) const
{
    std::string inside = path.lexically_normal().generic_string();
    while (inside.ends_with('/')) inside.pop_back();
    if (inside.empty() || inside == ".") return *this;
    return {store, prefix + inside + "/"};
}

ZarrPlace zarr_folder(const fs::path& folder)
{
    return {std::make_shared<FolderStore>(folder)};
}

std::optional<ZarrPlace> zarr_place(const fs::path& path)
{
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return zarr_folder(path);
    if (leads_to_network(path)) return ZarrPlace{open_remote_store(path.string())};
    const std::optional<PathIntoArchive> found = split(path);
    if (!found) return std::nullopt;
    return ZarrPlace{std::make_shared<ArchiveStore>(found->archive)} / found->inside;
}

bool leads_into_archive(const fs::path& path)
{
    return split(path).has_value();
}

}  // namespace shvr
