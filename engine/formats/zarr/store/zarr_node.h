#pragma once
// The metadata of a group or an array in a Zarr hierarchy: .zgroup, .zattrs and .zarray (version 2), or zarr.json
// (version 3). If files of both versions exist, version 3 is used, as in zarr-python. Any thread may call these.

#include <optional>
#include <string>

#include "engine/formats/zarr/store/zarr_json.h"

namespace shvr {

struct ZarrNode {
    int version = 2;        ///< version of Zarr
    bool is_array = false;  ///< otherwise a group
    /// Content of .zattrs or zarr.json. In version 2, an empty object for arrays, and for groups without attributes.
    JsonDocument document;

    JsonNode attributes() const;
    /// Returns OME-Zarr's attributes. Since version 0.5 they form a separate object, which may be missing if empty.
    JsonNode ome() const;
};

/// Returns null if the place is neither group nor array. Fails if its metadata is damaged, or of an unknown version.
std::optional<ZarrNode> read_zarr_node(const ZarrPlace& place);
/// Likewise, for the group or array at a path (zarr_place).
std::optional<ZarrNode> read_zarr_node(const std::filesystem::path& path);

/// Checks the keys that groups and arrays of version 3 share. Fails for any key not in `known`, unless it is marked as
/// ignorable (must_understand false).
void check_zarr_keys(const JsonNode& root, std::initializer_list<std::string_view> known);

}  // namespace shvr
