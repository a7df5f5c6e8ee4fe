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

/// A value, or a part of a value, that will be read soon.
struct ZarrWant {
    std::string key{};
    /// First byte of the part; negative: the part is the end of the value. Null: the whole value.
    std::optional<int64_t> offset{};
    int64_t bytes = 0;  ///< size of the part, or the maximum size of a whole value
};

class ZarrStore {
public:
    virtual ~ZarrStore() = default;
    /// Returns a value's path for messages: its file, or the archive's path followed by the entry's name.
    virtual std::filesystem::path path_of(const std::string& key) const = 0;
    /// Returns the size of a value in bytes; null if it does not exist. Fails if the size cannot be determined.
    virtual std::optional<int64_t> size_of(const std::string& key) const = 0;
    /// Reads a whole value; null if it does not exist. Fails if reading fails or if the value exceeds `max_bytes`.
    virtual std::optional<std::vector<std::byte>> read(const std::string& key, int64_t max_bytes) const = 0;
    /// Fills `part` with the bytes of a value from `offset` on. Fails if the value has fewer bytes.
    virtual void read_part(const std::string& key, int64_t offset, std::span<std::byte> part) const = 0;

    /// The first or the last bytes of a value, and the value's size.
    struct Edge {
        std::vector<std::byte> bytes{};
        int64_t value_bytes = 0;  ///< size of the whole value
    };
    /// Reads the first or the last `bytes` bytes of a value, or none if it has fewer; null if the value does not exist.
    /// Fails if reading fails.
    virtual std::optional<Edge> read_edge(const std::string& key, bool is_end, int64_t bytes) const;

    /// Whether every access takes long, so that many should run in parallel, and values cannot be listed.
    virtual bool is_remote() const { return false; }
    /// Reads values ahead, in parallel, for later calls of read, read_part and read_edge, which report failures.
    virtual void prepare(std::span<const ZarrWant>) const {}

    /// Calls `take` with every key that begins with `prefix` (empty, or ending with a slash), in no particular order
    /// and without the prefix. Stops and returns false if `take` returns false. Fails if a folder cannot be listed; a
    /// missing folder counts as empty.
    virtual bool list(const std::string& prefix, const std::function<bool(std::string_view key)>& take) const = 0;

    /// has(): the value certainly exists; lacks(): it certainly does not. Both return false if `size_of` fails.
    bool has(const std::string& key) const;
    bool lacks(const std::string& key) const;
};

/// The place of a group or an array: a store, and the prefix of its keys.
struct ZarrPlace {
    std::shared_ptr<const ZarrStore> store;
    std::string prefix{};  ///< "", or ends with a slash

    /// Returns the path of the value `name` for messages; the path of the place itself if `name` is "".
    std::filesystem::path path_of(const std::string& name) const;
    std::string key(const std::string& name) const { return prefix + name; }
    bool has(const std::string& name) const { return store->has(key(name)); }
    /// Returns the place of a group or an array inside this place. `path` is relative and contains no "..".
    ZarrPlace operator/(const std::filesystem::path& path) const;
};

/// Returns the place at a path: a folder, an archive, an address, or a path into an archive; null for other files.
/// Fails if the archive is damaged or the address cannot be read. The content need not be Zarr.
std::optional<ZarrPlace> zarr_place(const std::filesystem::path& path);
ZarrPlace zarr_folder(const std::filesystem::path& folder);

}  // namespace shvr
