#include "engine/formats/zarr/store/zarr_node.h"

#include <algorithm>

namespace shvr {
namespace {

ZarrNode version_3(const ZarrPlace& place)
{
    ZarrNode node{.version = 3, .document = read_zarr_json(place, "zarr.json", MAX_ZARR_ATTRIBUTE_BYTES)};
    const JsonNode root = node.document.root();
    root["zarr_format"].whole(3, 3);
    const std::array<std::string_view, 2> types{"group", "array"};
    node.is_array = root["node_type"].choice(types) == 1;
    if (const JsonNode attributes = root["attributes"]; attributes.exists() && !attributes.is_object())
        attributes.refuse("an object");
    // Ignores consolidated metadata, zarr-python's copy of the metadata below a group, in favour of the originals.
    if (!node.is_array) check_zarr_keys(root, {"zarr_format", "node_type", "attributes", "consolidated_metadata"});
    return node;
}

}  // namespace

JsonNode ZarrNode::attributes() const
{
    return version == 2 ? document.root() : document.root()["attributes"];
}

JsonNode ZarrNode::ome() const
{
    return version == 2 ? attributes() : attributes()["ome"];
}

std::optional<ZarrNode> read_zarr_node(const ZarrPlace& place)
{
    if (place.has("zarr.json")) return version_3(place);
    const bool is_array = place.has(".zarray");
    if (!is_array && !place.has(".zattrs") && !place.has(".zgroup")) return std::nullopt;
    return ZarrNode{.version = 2,
                    .is_array = is_array,
                    .document = !is_array && place.has(".zattrs")
                                    ? read_zarr_json(place, ".zattrs", MAX_ZARR_ATTRIBUTE_BYTES)
                                    : JsonDocument("{}", place.path_of(".zattrs").string())};
}

std::optional<ZarrNode> read_zarr_node(const std::filesystem::path& path)
{
    const std::optional<ZarrPlace> place = zarr_place(path);
    return place ? read_zarr_node(*place) : std::nullopt;
}

void check_zarr_keys(const JsonNode& root, std::initializer_list<std::string_view> known)
{
    for (const std::string& name : root.names()) {
        if (std::ranges::find(known, name) != known.end()) continue;
        const JsonNode value = root[name];
        const JsonNode needed = value["must_understand"];
        if (!needed.exists() || needed.flag()) value.refuse("no such key, or one with must_understand false");
    }
}

}  // namespace shvr
