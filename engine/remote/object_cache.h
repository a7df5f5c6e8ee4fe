#pragma once
// Objects that were read before, on disk: one file each, shared by all processes of a user, limited in bytes. A file
// appears completely or not at all, and states a checksum: a damaged one is removed, and counts as absent. The least
// recently used files are removed first. Any thread may call these.

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
    /// An empty folder, or a budget of 0: nothing is kept.
    ObjectCache(std::filesystem::path folder, int64_t budget_bytes);

    /// `name`: identifies an object or a part of one, and contains no credential. Files are never larger than
    /// `max_bytes`, or they count as absent.
    std::optional<CachedObject> find(const std::string& name, int64_t max_bytes) const;
    /// Keeps an object. A failure, such as a full disk, only means that it is not kept.
    void keep(const std::string& name, const CachedObject& object) const;

    /// Removes files, the least recently used first, until 90 % of the budget is not exceeded; does nothing if it is
    /// not exceeded, or if another process is removing files.
    void make_room() const;

private:
    std::filesystem::path path_of(const std::string& name) const;

    std::filesystem::path folder_;
    int64_t budget_bytes_;
    mutable std::atomic<int64_t> unchecked_bytes_;  ///< kept by this process since it last looked at the budget
    mutable std::atomic<uint64_t> written_ = 0;
};

/// The cache of this user: in SHVR_REMOTE_CACHE, or remote/ in the program's cache folder, of SHVR_REMOTE_CACHE_MIB
/// (4096 unless set; 0: none). Fails if that is not a whole number within its limits.
const ObjectCache& object_cache();

}  // namespace shvr
