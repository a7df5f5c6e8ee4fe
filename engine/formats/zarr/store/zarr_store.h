#pragma once
// Where the values of a Zarr hierarchy are kept, under keys such as "0/zarr.json": files of a folder, or entries of a
// zip archive (.ozx, or .zip). Any thread may call these.
//
// An .ozx is a zip whose root is the root of the hierarchy (https://ngff.openmicroscopy.org/rfc/9/). Its entries should
// be stored, not deflated; both are read. A path may lead into an archive: "scan.ozx/0".

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

class ZarrStore {
public:
    virtual ~ZarrStore() = default;
    /// For messages: the value's file, or the archive's path and the entry's name.
    virtual std::filesystem::path path_of(const std::string& key) const = 0;
    /// The bytes of a value; nothing if there is none. Fails if that cannot be determined.
    virtual std::optional<int64_t> size_of(const std::string& key) const = 0;
    /// A whole value; nothing if there is none. Fails if it cannot be read, or is larger than `max_bytes`.
    virtual std::optional<std::vector<std::byte>> read(const std::string& key, int64_t max_bytes) const = 0;
    /// The bytes of a value from `offset` on. Fails if the value has fewer.
    virtual void read_part(const std::string& key, int64_t offset, std::span<std::byte> part) const = 0;

    /// Calls `take` with every key that begins with `prefix` (which is empty or ends with a slash), less the prefix, in
    /// no order, until it returns false. False if it did. Fails if a folder cannot be listed; one that is missing has
    /// no keys.
    virtual bool list(const std::string& prefix, const std::function<bool(std::string_view key)>& take) const = 0;

    /// These are both false where `size_of` fails.
    bool has(const std::string& key) const;
    bool lacks(const std::string& key) const;
};

/// A group or an array: a store, and what its keys there begin with.
struct ZarrPlace {
    std::shared_ptr<const ZarrStore> store;
    std::string prefix{};  ///< "", or ends with a slash

    /// Where its value `name` is, for messages; with "", where it is itself.
    std::filesystem::path path_of(const std::string& name) const;
    std::string key(const std::string& name) const { return prefix + name; }
    bool has(const std::string& name) const { return store->has(key(name)); }
    /// A group or an array inside; `path` is relative and does not climb.
    ZarrPlace operator/(const std::filesystem::path& path) const;
};

/// The place of a folder or an archive, or of a path into an archive; nothing for other files. Fails if an archive is
/// damaged. What is there need not be Zarr.
std::optional<ZarrPlace> zarr_place(const std::filesystem::path& path);
ZarrPlace zarr_folder(const std::filesystem::path& folder);

}  // namespace shvr
