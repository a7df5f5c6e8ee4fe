#include "engine/formats/zarr/metadata/zarr_metadata.h"

#include <algorithm>
#include <bit>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/formats/zarr/metadata/zarr_fields.h"
#include "engine/formats/zarr/metadata/zarr_v3.h"
#include "engine/formats/zarr/store/zarr_json.h"

namespace shvr {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "byte order '<' is taken as it is");

struct DataType {
    const char* code;  ///< without byte order
    VoxelType type;
    StoredNumber number = StoredNumber::plain;
};
constexpr DataType DATA_TYPES[] = {{"u1", VoxelType::uint8},
                                   {"i1", VoxelType::int8},
                                   {"u2", VoxelType::uint16},
                                   {"i2", VoxelType::int16},
                                   {"u4", VoxelType::uint32},
                                   {"i4", VoxelType::int32},
                                   {"f4", VoxelType::float32},
                                   {"f8", VoxelType::float64},
                                   {"b1", VoxelType::uint8},
                                   {"i8", VoxelType::float64, StoredNumber::int64},
                                   {"u8", VoxelType::float64, StoredNumber::uint64},
                                   {"f2", VoxelType::uint16, StoredNumber::float16}};

using Kind = ZarrCompressor::Kind;
constexpr Spelling<Kind> COMPRESSORS[] = {
    {Kind::blosc, "blosc"}, {Kind::zstd, "zstd"}, {Kind::zlib, "zlib"}, {Kind::gzip, "gzip"}};

void read_data_type(const JsonNode& node, ZarrMetadata& metadata)
{
    const std::string text = node.is_text() ? node.any_text() : "";
    for (const DataType& known : DATA_TYPES) {
        if (text.size() != 3 || text.substr(1) != known.code) continue;
        metadata.type = known.type;
        metadata.stored = known.number;
        metadata.big_endian = text[0] == '>';
        const bool is_order = text[0] == '<' || text[0] == '>' || (text[0] == '|' && bytes_of(known.type) == 1);
        if (is_order) return;
    }
    node.refuse(
        "a number type such as \"|u1\", \"<u2\", \">i2\" or \"<f4\": integers of 8 to 64 bits, floats of 16 to 64, or "
        "bool");
}

std::vector<ZarrCompressor> read_compressor(const JsonNode& node)
{
    if (node.is_null()) return {};
    if (!node["id"].exists()) node.refuse("null, or a compressor whose id is blosc, zstd, zlib or gzip");
    const std::vector<std::string_view> names = names_of(std::span<const Spelling<Kind>>(COMPRESSORS));
    return {{.kind = COMPRESSORS[node["id"].choice(names)].value}};
}

void refuse_filters(const JsonNode& filters)
{
    if (filters.exists() && !filters.is_null() && !(filters.is_array() && filters.count() == 0))
        filters.refuse("none: filters are not supported");
}

ZarrMetadata read_version_2(const ZarrPlace& array)
{
    const JsonDocument document = read_zarr_json(array, ".zarray", MAX_ZARR_METADATA_BYTES);
    const JsonNode root = document.root();
    root["zarr_format"].whole(2, 2);
    ZarrMetadata metadata;
    metadata.shape = read_zarr_sides(root["shape"]);
    metadata.chunks = read_zarr_chunk(root["chunks"], metadata.shape.size());
    read_data_type(root["dtype"], metadata);
    check_zarr_chunk(root["chunks"], metadata);
    const std::array<std::string_view, 2> orders{"C", "F"}, separators{".", "/"};
    if (root["order"].choice(orders) == 1) {
        for (size_t axis = metadata.shape.size(); axis-- > 0;) metadata.order.push_back(axis);
    }
    if (const JsonNode separator = root["dimension_separator"]; separator.exists())
        metadata.separator = separators[separator.choice(separators)][0];
    read_zarr_fill(root["fill_value"], metadata);
    metadata.codecs = read_compressor(root["compressor"]);
    refuse_filters(root["filters"]);
    return metadata;
}

Json compressor_of(const std::vector<ZarrCompressor>& codecs)
{
    if (codecs.empty()) return nullptr;
    const ZarrCompressor& compressor = codecs[0];
    switch (compressor.kind) {
        case Kind::crc32c:  // not supported in version 2
        case Kind::none: return nullptr;
        case Kind::blosc:
            return {{"id", "blosc"},
                    {"cname", compressor.codec},
                    {"clevel", compressor.level},
                    {"shuffle", compressor.shuffle},
                    {"blocksize", 0}};
        case Kind::zstd: return {{"id", "zstd"}, {"level", compressor.level}};
        case Kind::zlib: return {{"id", "zlib"}, {"level", compressor.level}};
        case Kind::gzip: return {{"id", "gzip"}, {"level", compressor.level}};
    }
    return nullptr;
}

}  // namespace

int64_t ZarrSharding::chunks(const std::vector<int64_t>& chunk) const
{
    int64_t chunks = 1;
    for (size_t axis = 0; axis < shape.size(); ++axis) chunks *= shape[axis] / chunk[axis];
    return chunks;
}

size_t ZarrMetadata::chunk_bytes() const
{
    size_t bytes = bytes_of(type);
    for (const int64_t side : chunks) bytes *= size_t(side);
    return bytes;
}

std::vector<size_t> ZarrMetadata::strides() const
{
    std::vector<size_t> strides(chunks.size());
    size_t stride = bytes_of(type);
    for (size_t i = chunks.size(); i-- > 0;) {
        const size_t axis = order.empty() ? i : order[i];
        strides[axis] = stride;
        stride *= size_t(chunks[axis]);
    }
    return strides;
}

std::string ZarrMetadata::key_of(std::span<const int64_t> numbers) const
{
    std::string key = has_prefix ? "c" : "";
    for (const int64_t number : numbers) {
        if (!key.empty()) key += separator;
        key += std::to_string(number);
    }
    return key;
}

ZarrMetadata read_zarr_metadata(const ZarrPlace& array, int version)
{
    return version == 3 ? read_zarr_v3(array) : read_version_2(array);
}

std::string to_text(const ZarrMetadata& metadata)
{
    if (metadata.version == 3) return zarr_v3_text(metadata);
    std::string type(1, bytes_of(metadata.type) == 1 ? '|' : metadata.big_endian ? '>' : '<');
    const auto is_type = [&](const DataType& known) {  // bool comes after uint8
        return known.type == metadata.type && known.number == metadata.stored;
    };
    type += std::ranges::find_if(DATA_TYPES, is_type)->code;
    const Json document = {{"chunks", metadata.chunks},
                           {"compressor", compressor_of(metadata.codecs)},
                           {"dimension_separator", std::string(1, metadata.separator)},
                           {"dtype", type},
                           {"fill_value", zarr_fill(metadata)},
                           {"filters", nullptr},
                           {"order", metadata.order.empty() ? "C" : "F"},
                           {"shape", metadata.shape},
                           {"zarr_format", 2}};
    return document.dump(4) + "\n";
}

}  // namespace shvr
