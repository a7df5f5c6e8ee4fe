// Reads the core of the specification and the codecs that other programs write: bytes, transpose, blosc, gzip, zstd,
// zlib (as numcodecs.zlib), crc32c and sharding_indexed. The message about an unsupported codec names it.

#include "engine/formats/zarr/metadata/zarr_v3.h"

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/formats/zarr/metadata/zarr_fields.h"
#include "engine/formats/zarr/store/zarr_node.h"

namespace shvr {
namespace {

using Json = nlohmann::json;
using Kind = ZarrCompressor::Kind;

constexpr size_t MAX_CODECS = 16;
/// Maximum size of a shard's index, which is read as a whole: enough for four million chunks.
constexpr int64_t MAX_INDEX_BYTES = int64_t{64} << 20;

/// The prefix "numcodecs.", which zarr-python's numcodecs.zarr3 writes, does not change what a codec stores.
constexpr Spelling<Kind> CODECS[] = {{Kind::blosc, "blosc"},         {Kind::zstd, "zstd"},
                                     {Kind::gzip, "gzip"},           {Kind::crc32c, "crc32c"},
                                     {Kind::zlib, "zlib"},           {Kind::blosc, "numcodecs.blosc"},
                                     {Kind::zstd, "numcodecs.zstd"}, {Kind::gzip, "numcodecs.gzip"},
                                     {Kind::zlib, "numcodecs.zlib"}, {Kind::crc32c, "numcodecs.crc32c"}};
constexpr const char* KNOWN_CODECS =
    "one of \"bytes\", \"transpose\", \"sharding_indexed\", \"blosc\", \"zstd\", \"gzip\", \"zlib\", \"crc32c\"";
constexpr const char* CHAIN =
    "transpose as often as needed, then bytes or sharding_indexed, then at most one compressor and checksums";

/// Returns the name of an extension, which is an object with a name and perhaps a configuration, or just a name.
std::string name_of_extension(const JsonNode& node, const char* expected)
{
    if (!node.is_object() && !node.is_text()) node.refuse(expected);
    return (node.is_object() ? node["name"] : node).text(expected);
}

void read_type(const JsonNode& node, ZarrMetadata& metadata)
{
    static const std::string expected = sentence("bool, int64, uint64, float16, ", VOXEL_TYPE_NAMES);
    const std::string name = name_of_extension(node, expected.c_str());
    if (name == "bool") return;  // bytes of 0 and 1
    for (const StoredNumber number : {StoredNumber::int64, StoredNumber::uint64, StoredNumber::float16}) {
        if (name != name_of(number)) continue;
        metadata.stored = number;
        metadata.type = bits_type(number);
        return;
    }
    for (const VoxelType type : VOXEL_TYPES) {
        if (name != name_of(type)) continue;
        metadata.type = type;
        return;
    }
    node.refuse(expected);
}

const JsonNode grid_of(const JsonNode& root)
{
    const JsonNode grid = root["chunk_grid"];
    if (name_of_extension(grid, "a regular grid") != "regular") grid.refuse("a regular grid: others are not supported");
    return grid["configuration"].required("chunk_shape", "the shape of a chunk");
}

void read_keys(const JsonNode& node, ZarrMetadata& metadata)
{
    constexpr const char* EXPECTED = "an object whose name is \"default\" or \"v2\"";
    const std::string name = name_of_extension(node, EXPECTED);
    if (name != "default" && name != "v2") node.refuse(EXPECTED);
    metadata.has_prefix = name == "default";
    metadata.separator = metadata.has_prefix ? '/' : '.';
    const std::array<std::string_view, 2> separators{".", "/"};
    if (const JsonNode separator = node["configuration"]["separator"]; separator.exists())
        metadata.separator = separators[separator.choice(separators)][0];
}

// ---- Codecs ---------------------------------------------------------------------------------------------------------

bool read_is_big_endian(const JsonNode& codec, size_t voxel_bytes)
{
    const std::array<std::string_view, 2> orders{"little", "big"};
    const JsonNode order = codec["configuration"]["endian"];
    if (!order.exists() && voxel_bytes == 1) return false;
    return order.choice(orders) == 1;
}

/// Returns the order of the axes after a transpose codec; `before` is their order before it.
std::vector<size_t> transposed(const JsonNode& codec, const std::vector<size_t>& before)
{
    const JsonNode node = codec["configuration"].required("order", "a list of axes");
    const std::string expected = sentence("each of the axes 0 to ", before.size() - 1, " once");
    std::vector<size_t> order;
    for (const JsonNode& element : node.elements()) {
        const auto axis = size_t(element.whole(0, int64_t(before.size()) - 1));
        if (std::ranges::find(order, before[axis]) != order.end()) node.refuse(expected);
        order.push_back(before[axis]);
    }
    if (order.size() != before.size()) node.refuse(expected);
    return order;
}

/// A chain of codecs, split into the specification's stages: array to array, array to bytes, and bytes to bytes.
struct Chain {
    std::vector<size_t> order{};           ///< order of the axes after the transpositions
    std::optional<JsonNode> bytes{};       ///< the codec that converts an array to bytes
    std::vector<ZarrCompressor> codecs{};  ///< the codecs after `bytes`
    bool is_sharding = false;
    bool is_transposed = false;
};

Chain read_chain(const JsonNode& node, const std::vector<size_t>& axes)
{
    Chain chain{.order = axes};
    for (const JsonNode& codec : node.elements(1, MAX_CODECS)) {
        const std::string name = name_of_extension(codec, KNOWN_CODECS);
        if (name == "transpose" && !chain.bytes) {
            chain.order = transposed(codec, chain.order);
            chain.is_transposed = true;
        } else if ((name == "bytes" || name == "sharding_indexed") && !chain.bytes) {
            chain.bytes = codec;
            chain.is_sharding = name == "sharding_indexed";
        } else {
            const auto* const known = std::ranges::find(CODECS, name, &Spelling<Kind>::name);
            if (known == std::end(CODECS)) codec.refuse(name == "transpose" || name == "bytes" ? CHAIN : KNOWN_CODECS);
            if (!chain.bytes) node.refuse(CHAIN);
            const auto is_compressor = [](const ZarrCompressor& each) { return each.kind != Kind::crc32c; };
            if (known->value != Kind::crc32c && std::ranges::any_of(chain.codecs, is_compressor)) node.refuse(CHAIN);
            chain.codecs.push_back({.kind = known->value});
        }
    }
    if (!chain.bytes) node.refuse(CHAIN);
    return chain;
}

/// Returns `order`, or an empty list if it is the array's own order.
std::vector<size_t> unless_plain(std::vector<size_t> order)
{
    return std::ranges::is_sorted(order) ? std::vector<size_t>() : order;
}

void read_index(const JsonNode& configuration, ZarrSharding& sharding)
{
    const JsonNode node = configuration.required("index_codecs", "a list of codecs");
    const Chain chain = read_chain(node, sharding.order);
    const bool has_fixed_size =
        std::ranges::all_of(chain.codecs, [](const ZarrCompressor& codec) { return codec.kind == Kind::crc32c; });
    if (chain.is_sharding || chain.is_transposed || !has_fixed_size)
        node.refuse("bytes, then perhaps crc32c: an index has a fixed size");
    sharding.is_big_endian = read_is_big_endian(*chain.bytes, sizeof(uint64_t));
    sharding.checksums = int(chain.codecs.size());
    const std::array<std::string_view, 2> places{"start", "end"};
    const JsonNode place = configuration["index_location"];
    sharding.is_index_first = place.exists() && place.choice(places) == 0;
}

/// Reads the metadata of shards. Afterwards `chunks` is the shape of the chunks in a shard, which are read one by one.
void read_sharding(const Chain& outer, ZarrMetadata& metadata)
{
    const JsonNode configuration = (*outer.bytes)["configuration"];
    ZarrSharding sharding{.shape = metadata.chunks, .order = outer.order};
    const JsonNode shape = configuration.required("chunk_shape", "the shape of a chunk inside a shard");
    const std::vector<int64_t> sides = read_zarr_chunk(shape, metadata.shape.size());
    int64_t chunks = 1;
    for (size_t i = 0; i < sides.size(); ++i) {
        const size_t axis = outer.order[i];
        if (sharding.shape[axis] % sides[i] != 0) shape.refuse("sides that divide those of the shard");
        metadata.chunks[axis] = sides[i];
        if (__builtin_mul_overflow(chunks, sharding.shape[axis] / sides[i], &chunks) || chunks > MAX_INDEX_BYTES / 16) {
            shape.refuse(sentence("shards of at most ", MAX_INDEX_BYTES / 16, " chunks"));
        }
    }
    check_zarr_chunk(shape, metadata);
    if (!outer.codecs.empty()) {
        outer.bytes->refuse("no codec after it: shards that are compressed as a whole are not supported");
    }
    const JsonNode codecs = configuration.required("codecs", "a list of codecs");
    const Chain inner = read_chain(codecs, outer.order);
    if (inner.is_sharding) codecs.refuse("no shards inside a shard, which are not supported");
    metadata.order = unless_plain(inner.order);
    metadata.big_endian = read_is_big_endian(*inner.bytes, bytes_of(metadata.type));
    metadata.codecs = inner.codecs;
    read_index(configuration, sharding);
    metadata.sharding = std::move(sharding);
}

void read_codecs(const JsonNode& node, const JsonNode& chunk_shape, ZarrMetadata& metadata)
{
    std::vector<size_t> axes(metadata.shape.size());
    std::iota(axes.begin(), axes.end(), size_t{0});
    const Chain chain = read_chain(node, axes);
    if (chain.is_sharding) return read_sharding(chain, metadata);
    check_zarr_chunk(chunk_shape, metadata);
    metadata.order = unless_plain(chain.order);
    metadata.big_endian = read_is_big_endian(*chain.bytes, bytes_of(metadata.type));
    metadata.codecs = chain.codecs;
}

// ---- The rest -------------------------------------------------------------------------------------------------------

void read_axis_names(const JsonNode& node, ZarrMetadata& metadata)
{
    if (!node.exists() || node.is_null()) return;
    const size_t axes = metadata.shape.size();
    for (const JsonNode& name : node.elements(axes, axes))
        metadata.axes.push_back(name.is_null() ? std::string() : name.any_text());
}

Json codec_of(const ZarrCompressor& codec, size_t voxel_bytes)
{
    constexpr const char* SHUFFLES[] = {"noshuffle", "shuffle", "bitshuffle"};
    const auto with_level = [&](const char* name, Json configuration) {
        configuration["level"] = codec.level;
        return Json{{"name", name}, {"configuration", configuration}};
    };
    switch (codec.kind) {
        case Kind::none: return nullptr;
        case Kind::blosc:
            return {{"name", "blosc"},
                    {"configuration",
                     {{"cname", codec.codec},
                      {"clevel", codec.level},
                      {"shuffle", SHUFFLES[codec.shuffle]},
                      {"typesize", voxel_bytes},
                      {"blocksize", 0}}}};
        case Kind::zstd: return with_level("zstd", {{"checksum", false}});
        case Kind::zlib: return with_level("numcodecs.zlib", Json::object());
        case Kind::gzip: return with_level("gzip", Json::object());
        case Kind::crc32c: return {{"name", "crc32c"}};
    }
    return nullptr;
}

/// Returns the sharding codec's metadata. `codecs`: metadata of the codecs for each chunk in a shard.
Json sharding_of(const ZarrMetadata& metadata, const Json& codecs)
{
    const ZarrSharding& sharding = *metadata.sharding;
    SHVR_CHECK(!sharding.is_big_endian && sharding.checksums == 1 && std::ranges::is_sorted(sharding.order));
    const Json bytes = {{"name", "bytes"}, {"configuration", {{"endian", "little"}}}};
    return {{"name", "sharding_indexed"},
            {"configuration",
             {{"chunk_shape", metadata.chunks},
              {"codecs", codecs},
              {"index_codecs", Json::array({bytes, {{"name", "crc32c"}}})},
              {"index_location", sharding.is_index_first ? "start" : "end"}}}};
}

}  // namespace

ZarrMetadata read_zarr_v3(const ZarrPlace& array)
{
    const JsonDocument document = read_zarr_json(array, "zarr.json", MAX_ZARR_ATTRIBUTE_BYTES);
    const JsonNode root = document.root();
    root["zarr_format"].whole(3, 3);
    const std::array<std::string_view, 1> array_only{"array"};
    root["node_type"].choice(array_only);
    check_zarr_keys(root, {"zarr_format", "node_type", "shape", "data_type", "chunk_grid", "chunk_key_encoding",
                           "fill_value", "codecs", "attributes", "storage_transformers", "dimension_names"});
    ZarrMetadata metadata{.version = 3};
    metadata.shape = read_zarr_sides(root["shape"]);
    read_type(root["data_type"], metadata);
    const JsonNode chunk_shape = grid_of(root);
    metadata.chunks = read_zarr_chunk(chunk_shape, metadata.shape.size());
    read_keys(root["chunk_key_encoding"], metadata);
    read_zarr_fill(root.required("fill_value", "the value of voxels that are not stored"), metadata);
    read_codecs(root["codecs"], chunk_shape, metadata);
    if (const JsonNode transformers = root["storage_transformers"]; transformers.count() > 0)
        transformers.refuse("none: storage transformers are not supported");
    read_axis_names(root["dimension_names"], metadata);
    return metadata;
}

std::string zarr_v3_text(const ZarrMetadata& metadata)
{
    SHVR_CHECK(metadata.order.empty());
    const Json bytes = {{"name", "bytes"}, {"configuration", {{"endian", metadata.big_endian ? "big" : "little"}}}};
    Json codecs = Json::array({bytes});
    for (const ZarrCompressor& codec : metadata.codecs) {
        if (codec.kind != Kind::none) codecs.push_back(codec_of(codec, bytes_of(metadata.type)));
    }
    if (metadata.sharding) codecs = Json::array({sharding_of(metadata, codecs)});
    const std::vector<int64_t>& grid = metadata.sharding ? metadata.sharding->shape : metadata.chunks;
    Json document = {{"attributes", Json::object()},
                     {"chunk_grid", {{"name", "regular"}, {"configuration", {{"chunk_shape", grid}}}}},
                     {"chunk_key_encoding",
                      {{"name", metadata.has_prefix ? "default" : "v2"},
                       {"configuration", {{"separator", std::string(1, metadata.separator)}}}}},
                     {"codecs", codecs},
                     {"data_type", name_of(metadata.type)},
                     {"fill_value", zarr_fill(metadata)},
                     {"node_type", "array"},
                     {"shape", metadata.shape},
                     {"zarr_format", 3}};
    if (!metadata.axes.empty()) document["dimension_names"] = metadata.axes;
    return document.dump(4) + "\n";
}

}  // namespace shvr
