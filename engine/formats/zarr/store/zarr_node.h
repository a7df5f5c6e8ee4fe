#pragma once
// What a group or an array of a Zarr hierarchy says of itself: in .zgroup, .zattrs and .zarray (version 2), or in
// zarr.json (version 3). Where both are there, version 3 counts, as it does for zarr-python. Any thread may call these.

#include <optional>
#include <string>

#include "engine/formats/zarr/zarr_json.h"

namespace shvr {

struct ZarrNode {
    int version = 2;        ///< of Zarr
    bool is_array = false;  ///< otherwise a group
    /// .zattrs or zarr.json; of arrays of version 2, and of groups without attributes, an empty object.
    JsonDocument document;

    JsonNode attributes() const;
    /// The attributes of OME-Zarr: since 0.5 in an object of their own, which is missing where there are none.
    JsonNode ome() const;
};

/// Nothing if the place is neither group nor array. Fails if its metadata are damaged, or of an unknown version.
std::optional<ZarrNode> read_zarr_node(const ZarrPlace& place);
/// The same for the place of a path (zarr_place).
std::optional<ZarrNode> read_zarr_node(const std::filesystem::path& path);

/// Version 3: the common keys of the metadata of groups and arrays. Fails if there are others than `known`, unless they
/// say that they need not be understood.
void check_zarr_keys(const JsonNode& root, std::initializer_list<std::string_view> known);

}  // namespace shvr
