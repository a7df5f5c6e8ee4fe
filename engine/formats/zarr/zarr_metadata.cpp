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

constexpr size_t MOST_AXES = 16;

struct DataType {
    const char* code;  ///< without byte order
    VoxelType type;
};
constexpr DataType DATA_TYPES[] = {{"u1", VoxelType::uint8},   {"i1", VoxelType::int8},   {"u2", VoxelType::uint16},
                                   {"i2", VoxelType::int16},   {"u4", VoxelType::uint32}, {"i4", VoxelType::int32},
                                   {"f4", VoxelType::float32}, {"f8", VoxelType::float64}};

struct CompressorName {
    const char* id;
    ZarrCompressor::Kind kind;
};
constexpr CompressorName COMPRESSORS[] = {{"blosc", ZarrCompressor::Kind::blosc},
                                          {"zstd", ZarrCompressor::Kind::zstd},
                                          {"zlib", ZarrCompressor::Kind::zlib},
                                          {"gzip", ZarrCompressor::Kind::gzip}};

std::vector<int64_t> sides(const Path& path, const Json& document, const char* key)
{
    const std::string expected = sentence("1 to ", MOST_AXES, " whole numbers from 1 to 2^62");
    const Json& value = required(path, document, key, expected);
    if (!value.is_array() || value.empty() || value.size() > MOST_AXES) refuse_json(path, key, value, expected);
    std::vector<int64_t> sides;
    for (const Json& side : value) {
        if (!side.is_number_unsigned() || side.get<uint64_t>() < 1 || side.get<uint64_t>() > uint64_t{1} << 62) {
            refuse_json(path, key, value, expected);
        }
        sides.push_back(side.get<int64_t>());
    }
    return sides;
}

void read_data_type(const Path& path, const Json& document, ZarrMetadata& metadata)
{
    constexpr const char* EXPECTED =
        "a number type such as \"|u1\", \"<u2\", \">i2\" or \"<f4\": integers of 8, 16 or 32 bits, floats of 32 or 64";
    const Json& value = required(path, document, "dtype", EXPECTED);
    if (!value.is_string()) refuse_json(path, "dtype", value, EXPECTED);
    const auto& text = value.get_ref<const std::string&>();
    for (const DataType& known : DATA_TYPES) {
        if (text.size() != 3 || text.substr(1) != known.code) continue;
        metadata.type = known.type;
        metadata.big_endian = text[0] == '>';
        const bool is_order = text[0] == '<' || text[0] == '>' || (text[0] == '|' && bytes_of(known.type) == 1);
        if (is_order) return;
    }
    refuse_json(path, "dtype", value, EXPECTED);
}

template <class T>
void put(T value, ZarrMetadata& metadata)
{
    std::memcpy(metadata.fill.data(), &value, sizeof(value));
}

template <class T>
void put_whole(const Path& path, const Json& value, ZarrMetadata& metadata)
{
    using Limits = std::numeric_limits<T>;
    const std::string expected =
        sentence("a whole number from ", int64_t{Limits::min()}, " to ", int64_t{Limits::max()}, ", or null");
    if (!value.is_number()) refuse_json(path, "fill_value", value, expected);
    const auto number = value.get<double>();  // exact: no type here has more than 32 bits
    const bool fits =
        number == std::floor(number) && number >= double{Limits::min()} && number <= double{Limits::max()};
    if (!fits) refuse_json(path, "fill_value", value, expected);
    put(static_cast<T>(number), metadata);
}

double float_fill(const Path& path, const Json& value)
{
    if (value.is_number()) return value.get<double>();
    if (value == "NaN") return std::numeric_limits<double>::quiet_NaN();
    if (value == "Infinity") return std::numeric_limits<double>::infinity();
    if (value == "-Infinity") return -std::numeric_limits<double>::infinity();
    refuse_json(path, "fill_value", value, "a number, \"NaN\", \"Infinity\", \"-Infinity\" or null");
}

void read_fill_value(const Path& path, const Json& document, ZarrMetadata& metadata)
{
    const auto found = document.find("fill_value");
    // null leaves such voxels undefined; 0 is what other readers give.
    if (found == document.end() || found->is_null()) return;
    switch (metadata.type) {
        case VoxelType::uint8: return put_whole<uint8_t>(path, *found, metadata);
        case VoxelType::int8: return put_whole<int8_t>(path, *found, metadata);
        case VoxelType::uint16: return put_whole<uint16_t>(path, *found, metadata);
        case VoxelType::int16: return put_whole<int16_t>(path, *found, metadata);
        case VoxelType::uint32: return put_whole<uint32_t>(path, *found, metadata);
        case VoxelType::int32: return put_whole<int32_t>(path, *found, metadata);
        case VoxelType::float32: {
            const double fill = float_fill(path, *found);
            if (std::isfinite(fill) && std::abs(fill) > double{std::numeric_limits<float>::max()}) {
                refuse_json(path, "fill_value", *found, "a number that 32-bit floats hold");
            }
            return put(static_cast<float>(fill), metadata);
        }
        case VoxelType::float64: return put(float_fill(path, *found), metadata);
    }
}

ZarrCompressor::Kind compressor_kind(const Path& path, const Json& document)
{
    constexpr const char* EXPECTED = "null, or a compressor whose id is blosc, zstd, zlib or gzip";
    const Json& value = required(path, document, "compressor", EXPECTED);
    if (value.is_null()) return ZarrCompressor::Kind::none;
    const auto id = value.is_object() ? value.find("id") : value.end();
    if (!value.is_object() || id == value.end()) refuse_json(path, "compressor", value, EXPECTED);
    for (const CompressorName& known : COMPRESSORS) {
        if (*id == known.id) return known.kind;
    }
    refuse_json(path, "compressor.id", *id, "blosc, zstd, zlib or gzip");
}

void refuse_filters(const Path& path, const Json& document)
{
    const auto filters = document.find("filters");
    if (filters == document.end() || filters->is_null() || (filters->is_array() && filters->empty())) return;
    refuse_json(path, "filters", *filters, "none: filters are not supported");
}

void check_chunk_bytes(const Path& path, const ZarrMetadata& metadata)
{
    auto bytes = static_cast<int64_t>(bytes_of(metadata.type));
    for (const int64_t side : metadata.chunks) {
        if (!__builtin_mul_overflow(bytes, side, &bytes) && bytes <= LARGEST_CHUNK_BYTES) continue;
        refuse_json(path, "chunks", metadata.chunks,
                    sentence("chunks of at most ", LARGEST_CHUNK_BYTES >> 20, " MiB, which are decoded as a whole"));
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
    for (const int64_t side : chunks) bytes *= static_cast<size_t>(side);
    return bytes;
}

ZarrMetadata read_zarr_metadata(const Path& array)
{
    const Path path = array / ".zarray";
    const Json document = read_json_object(path, LARGEST_ZARR_METADATA);
    const Json& version = required(path, document, "zarr_format", "2");
    if (version != 2) refuse_json(path, "zarr_format", version, "2");

    ZarrMetadata metadata;
    metadata.shape = sides(path, document, "shape");
    metadata.chunks = sides(path, document, "chunks");
    if (metadata.chunks.size() != metadata.shape.size()) {
        refuse_json(path, "chunks", metadata.chunks, sentence("as many numbers as shape has, ", metadata.shape.size()));
    }
    read_data_type(path, document, metadata);
    check_chunk_bytes(path, metadata);
    const Json& order = required(path, document, "order", "\"C\" or \"F\"");
    if (order != "C" && order != "F") refuse_json(path, "order", order, "\"C\" or \"F\"");
    metadata.is_fortran = order == "F";
    if (const auto separator = document.find("dimension_separator"); separator != document.end()) {
        if (*separator != "." && *separator != "/") {
            refuse_json(path, "dimension_separator", *separator, "\".\" or \"/\"");
        }
        metadata.separator = separator->get_ref<const std::string&>()[0];
    }
    read_fill_value(path, document, metadata);
    metadata.compressor.kind = compressor_kind(path, document);
    refuse_filters(path, document);
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
