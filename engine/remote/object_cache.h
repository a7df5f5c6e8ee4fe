#pragma once
// A cache on disk of objects read before: one file per object, shared by all processes of a user, limited in bytes.
// Files are written atomically and contain a checksum; a damaged file is removed and counts as absent. The least
// recently used files are evicted first. Any thread may call these.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace shvr {

struct CachedObject {
    bool is_missing = false;  ///< the server had no such object
    std::string etag{};
    int64_t object_bytes = -1;  ///< size of the whole object; below 0: unknown
    std::vector<std::byte> bytes{};
};

class ObjectCache {
public:
    /// With an empty folder or a budget of 0, nothing is stored.
    ObjectCache(std::filesystem::path folder, int64_t budget_bytes);

    /// Returns the object or part of an object called `name`, which contains no credential. A file larger than
    /// `max_bytes` counts as absent.
    std::optional<CachedObject> find(const std::string& name, int64_t max_bytes) const;
    /// Stores an object. After a failure, such as a full disk, the object is merely not stored.
    void keep(const std::string& name, const CachedObject& object) const;

    /// If the files exceed the budget, removes the least recently used ones until 90 % of the budget remains in use.
    /// Does nothing if another process is already removing files.
    void make_room() const;

private:
    std::filesystem::path path_of(const std::string& name) const;

    std::filesystem::path folder_;
    int64_t budget_bytes_;
    mutable std::atomic<int64_t> unchecked_bytes_;  ///< bytes this process stored since it last measured the cache
    mutable std::atomic<uint64_t> written_ = 0;
};

/// The cache of this user: in SHVR_REMOTE_CACHE, or else remote/ in the program's cache folder. SHVR_REMOTE_CACHE_MIB
/// is its budget (default 4096; 0: no cache). Fails if that variable is not a whole number within its limits.
const ObjectCache& object_cache();

}  // namespace shvr
