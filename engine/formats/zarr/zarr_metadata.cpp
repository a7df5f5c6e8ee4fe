#include "engine/formats/zarr/zarr_metadata.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/formats/zarr/zarr_json.h"

namespace shvr {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

static_assert(std::endian::native == std::endian::little, "byte order '<' is taken as it is");

constexpr size_t MAX_AXES = 16;

struct DataType {
    const char* code;  ///< without byte order
    VoxelType type;
};
constexpr DataType DATA_TYPES[] = {{"u1", VoxelType::uint8},   {"i1", VoxelType::int8},   {"u2", VoxelType::uint16},
                                   {"i2", VoxelType::int16},   {"u4", VoxelType::uint32}, {"i4", VoxelType::int32},
                                   {"f4", VoxelType::float32}, {"f8", VoxelType::float64}};

using Kind = ZarrCompressor::Kind;
constexpr Spelling<Kind> COMPRESSORS[] = {
    {Kind::blosc, "blosc"}, {Kind::zstd, "zstd"}, {Kind::zlib, "zlib"}, {Kind::gzip, "gzip"}};

std::vector<int64_t> read_sides(const JsonNode& node)
{
    std::vector<int64_t> sides;
    for (const JsonNode& side : node.elements(1, MAX_AXES)) sides.push_back(side.whole(1, int64_t{1} << 62));
    return sides;
}

void read_data_type(const JsonNode& node, ZarrMetadata& metadata)
{
    const std::string text = node.is_text() ? node.any_text() : "";
    for (const DataType& known : DATA_TYPES) {
        if (text.size() != 3 || text.substr(1) != known.code) continue;
        metadata.type = known.type;
        metadata.big_endian = text[0] == '>';
        const bool is_order = text[0] == '<' || text[0] == '>' || (text[0] == '|' && bytes_of(known.type) == 1);
        if (is_order) return;
    }
    node.refuse(
        "a number type such as \"|u1\", \"<u2\", \">i2\" or \"<f4\": integers of 8, 16 or 32 bits, floats of 32 or 64");
}

template <class T>
void put(T value, ZarrMetadata& metadata)
{
    std::memcpy(metadata.fill.data(), &value, sizeof(value));
}

template <class T>
void put_whole(const JsonNode& fill, ZarrMetadata& metadata)
{
    using Limits = std::numeric_limits<T>;
    put(static_cast<T>(fill.whole(int64_t{Limits::min()}, int64_t{Limits::max()})), metadata);
}

double float_fill(const JsonNode& fill)
{
    if (fill.is("NaN")) return std::numeric_limits<double>::quiet_NaN();
    if (fill.is("Infinity")) return std::numeric_limits<double>::infinity();
    if (fill.is("-Infinity")) return -std::numeric_limits<double>::infinity();
    if (!fill.is_number()) fill.refuse("a number, \"NaN\", \"Infinity\", \"-Infinity\" or null");
    return fill.number(any_number());
}

void read_fill_value(const JsonNode& fill, ZarrMetadata& metadata)
{
    // null leaves such voxels undefined; other readers return 0.
    if (!fill.exists() || fill.is_null()) return;
    switch (metadata.type) {
        case VoxelType::uint8: return put_whole<uint8_t>(fill, metadata);
        case VoxelType::int8: return put_whole<int8_t>(fill, metadata);
        case VoxelType::uint16: return put_whole<uint16_t>(fill, metadata);
        case VoxelType::int16: return put_whole<int16_t>(fill, metadata);
        case VoxelType::uint32: return put_whole<uint32_t>(fill, metadata);
        case VoxelType::int32: return put_whole<int32_t>(fill, metadata);
        case VoxelType::float32: {
            const double value = float_fill(fill);
            if (std::isfinite(value) && std::abs(value) > double{std::numeric_limits<float>::max()})
                fill.refuse("a number that 32-bit floats hold");
            return put(float(value), metadata);
        }
        case VoxelType::float64: return put(float_fill(fill), metadata);
    }
}

Kind read_compressor(const JsonNode& node)
{
    if (node.is_null()) return Kind::none;
    if (!node["id"].exists()) node.refuse("null, or a compressor whose id is blosc, zstd, zlib or gzip");
    const std::vector<std::string_view> names = names_of(std::span<const Spelling<Kind>>(COMPRESSORS));
    return COMPRESSORS[node["id"].choice(names)].value;
}

void refuse_filters(const JsonNode& filters)
{
    if (filters.exists() && !filters.is_null() && !(filters.is_array() && filters.count() == 0))
        filters.refuse("none: filters are not supported");
}

void check_chunk_bytes(const JsonNode& node, const ZarrMetadata& metadata)
{
    auto bytes = int64_t(bytes_of(metadata.type));
    for (const int64_t side : metadata.chunks) {
        if (!__builtin_mul_overflow(bytes, side, &bytes) && bytes <= LARGEST_CHUNK_BYTES) continue;
        node.refuse(sentence("chunks of at most ", LARGEST_CHUNK_BYTES >> 20, " MiB, which are decoded as a whole"));
    }
}

Json fill_of(const ZarrMetadata& metadata)
{
    const auto value = [&]<class T>(T zero) {
        std::memcpy(&zero, metadata.fill.data(), sizeof(T));
        return zero;
    };
    const auto number = [](double fill) {
        if (std::isnan(fill)) return Json("NaN");
        if (std::isinf(fill)) return Json(fill > 0.0 ? "Infinity" : "-Infinity");
        return Json(fill);
    };
    switch (metadata.type) {
        case VoxelType::uint8: return value(uint8_t{});
        case VoxelType::int8: return value(int8_t{});
        case VoxelType::uint16: return value(uint16_t{});
        case VoxelType::int16: return value(int16_t{});
        case VoxelType::uint32: return value(uint32_t{});
        case VoxelType::int32: return value(int32_t{});
        case VoxelType::float32: return number(value(float{}));
        case VoxelType::float64: return number(value(double{}));
    }
    return nullptr;
}

Json compressor_of(const ZarrCompressor& compressor)
{
    switch (compressor.kind) {
        case ZarrCompressor::Kind::none: return nullptr;
        case ZarrCompressor::Kind::blosc:
            return {{"id", "blosc"},
                    {"cname", compressor.codec},
                    {"clevel", compressor.level},
                    {"shuffle", compressor.shuffle},
                    {"blocksize", 0}};
        case ZarrCompressor::Kind::zstd: return {{"id", "zstd"}, {"level", compressor.level}};
        case ZarrCompressor::Kind::zlib: return {{"id", "zlib"}, {"level", compressor.level}};
        case ZarrCompressor::Kind::gzip: return {{"id", "gzip"}, {"level", compressor.level}};
    }
    return nullptr;
}

}  // namespace

size_t ZarrMetadata::chunk_bytes() const
{
    size_t bytes = bytes_of(type);
    for (const int64_t side : chunks) bytes *= size_t(side);
    return bytes;
}

ZarrMetadata read_zarr_metadata(const Path& array)
{
    const JsonDocument document = read_zarr_json(array / ".zarray", LARGEST_ZARR_METADATA);
    const JsonNode root = document.root();
    root["zarr_format"].whole(2, 2);
    ZarrMetadata metadata;
    metadata.shape = read_sides(root["shape"]);
    metadata.chunks = read_sides(root["chunks"]);
    if (metadata.chunks.size() != metadata.shape.size())
        root["chunks"].refuse(sentence("as many numbers as shape has, ", metadata.shape.size()));
    read_data_type(root["dtype"], metadata);
    check_chunk_bytes(root["chunks"], metadata);
    const std::array<std::string_view, 2> orders{"C", "F"}, separators{".", "/"};
    metadata.is_fortran = root["order"].choice(orders) == 1;
    if (const JsonNode separator = root["dimension_separator"]; separator.exists())
        metadata.separator = separators[separator.choice(separators)][0];
    read_fill_value(root["fill_value"], metadata);
    metadata.compressor.kind = read_compressor(root["compressor"]);
    refuse_filters(root["filters"]);
    return metadata;
}

std::string to_text(const ZarrMetadata& metadata)
{
    std::string type(1, bytes_of(metadata.type) == 1 ? '|' : metadata.big_endian ? '>' : '<');
    for (const DataType& known : DATA_TYPES) {
        if (known.type == metadata.type) type += known.code;
    }
    const Json document = {{"chunks", metadata.chunks},
                           {"compressor", compressor_of(metadata.compressor)},
                           {"dimension_separator", std::string(1, metadata.separator)},
                           {"dtype", type},
                           {"fill_value", fill_of(metadata)},
                           {"filters", nullptr},
                           {"order", metadata.is_fortran ? "F" : "C"},
                           {"shape", metadata.shape},
                           {"zarr_format", 2}};
    return document.dump(4) + "\n";
}

}  // namespace shvr
