#pragma once
// Storage of the values of a Zarr hierarchy, under keys such as "0/zarr.json": files of a folder, entries of a zip
// archive (.ozx, or .zip), or objects below an address (remote_store.h). Any thread may call these.
//
// An .ozx is a zip whose root is the root of the hierarchy (https://ngff.openmicroscopy.org/rfc/9/). Its entries should
// be stored; deflated entries are read too. A path may lead into an archive: "scan.ozx/0".

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shvr {

/// A value, or a part of it, that will be read soon.
struct ZarrWant {
    std::string key{};
    /// First byte of the part; below 0: the part is the value's last bytes. Null: the whole value.
    std::optional<int64_t> offset{};
    int64_t bytes = 0;  ///< size of the part, or the most that a whole value may have
};

class ZarrStore {
public:
    virtual ~ZarrStore() = default;
    /// The value's place for messages: its file, or the archive's path and the entry's name.
    virtual std::filesystem::path path_of(const std::string& key) const = 0;
    /// The size of a value in bytes; null if the value does not exist. Fails if the size cannot be determined.
    virtual std::optional<int64_t> size_of(const std::string& key) const = 0;
    /// Reads a whole value; null if it does not exist. Fails if it cannot be read, or is larger than `max_bytes`.
    virtual std::optional<std::vector<std::byte>> read(const std::string& key, int64_t max_bytes) const = 0;
    /// Fills `part` with the bytes of a value from `offset` on. Fails if the value has fewer bytes.
    virtual void read_part(const std::string& key, int64_t offset, std::span<std::byte> part) const = 0;

    /// The first or the last bytes of a value.
    struct Edge {
        std::vector<std::byte> bytes{};
        int64_t value_bytes = 0;  ///< size of the whole value
    };
    /// Reads the first or the last bytes of a value, or none if the value has fewer; null if it does not exist. Fails
    /// if it cannot be read.
    virtual std::optional<Edge> read_edge(const std::string& key, bool is_end, int64_t bytes) const;

    /// Whether each access takes long, so that many should be made at once, and values cannot be listed.
    virtual bool is_remote() const { return false; }
    /// Reads values in parallel, for calls of read, read_part and read_edge that follow. Failures are left to those.
    virtual void prepare(std::span<const ZarrWant>) const {}

    /// Calls `take` with every key that begins with `prefix` (empty, or ending with a slash), in no particular order
    /// and with the prefix removed. If `take` returns false, stops and returns false too. Fails if a folder cannot be
    /// listed; a missing folder has no keys.
    virtual bool list(const std::string& prefix, const std::function<bool(std::string_view key)>& take) const = 0;

    /// Whether the value certainly exists; whether it certainly does not. Both return false if `size_of` fails.
    bool has(const std::string& key) const;
    bool lacks(const std::string& key) const;
};

/// The place of a group or an array: a store, and the prefix of its keys.
struct ZarrPlace {
    std::shared_ptr<const ZarrStore> store;
    std::string prefix{};  ///< "", or ends with a slash

    /// Returns the path of the value `name`, for messages; if `name` is "", the path of the place itself.
    std::filesystem::path path_of(const std::string& name) const;
    std::string key(const std::string& name) const { return prefix + name; }
    bool has(const std::string& name) const { return store->has(key(name)); }
    /// Returns the place of a group or an array inside this place; `path` is relative and contains no "..".
    ZarrPlace operator/(const std::filesystem::path& path) const;
};

/// Returns the place of a folder, an archive or an address, or of a path into an archive; null for other files. Fails
/// if an archive is damaged, or an address cannot be read. The content need not be Zarr.
std::optional<ZarrPlace> zarr_place(const std::filesystem::path& path);
ZarrPlace zarr_folder(const std::filesystem::path& folder);

}  // namespace shvr
