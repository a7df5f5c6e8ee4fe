#pragma once
// Metadata of a group or an array of a Zarr hierarchy: in .zgroup, .zattrs and .zarray (version 2), or in zarr.json
// (version 3). If both exist, version 3 is used, as in zarr-python. Any thread may call these.

#include <optional>
#include <string>

#include "engine/formats/zarr/store/zarr_json.h"

namespace shvr {

struct ZarrNode {
    int version = 2;        ///< version of Zarr
    bool is_array = false;  ///< otherwise a group
    /// Content of .zattrs or zarr.json; for version 2, an empty object for arrays and for groups without attributes.
    JsonDocument document;

    JsonNode attributes() const;
    /// The attributes of OME-Zarr. Since 0.5 they form a separate object, which may be missing if empty.
    JsonNode ome() const;
};

/// Returns null if the place is neither group nor array. Fails if its metadata is damaged, or of an unknown version.
std::optional<ZarrNode> read_zarr_node(const ZarrPlace& place);
/// Likewise, for the place that a path refers to (zarr_place).
std::optional<ZarrNode> read_zarr_node(const std::filesystem::path& path);

/// Checks the keys that metadata of groups and arrays share in version 3. Fails for keys other than `known`, unless
/// they are marked as ignorable (must_understand false).
void check_zarr_keys(const JsonNode& root, std::initializer_list<std::string_view> known);

}  // namespace shvr
