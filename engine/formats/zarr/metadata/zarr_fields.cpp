#include "engine/formats/zarr/metadata/zarr_fields.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"

namespace shvr {
namespace {

using Json = nlohmann::json;

constexpr size_t MAX_AXES = 16;

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

/// Sets the fill value from its bits as hexadecimal text: "0x", then two digits per byte, highest bits first.
template <class Bits>
bool put_bits(const JsonNode& fill, ZarrMetadata& metadata)
{
    const std::string text = metadata.version == 3 && fill.is_text() ? fill.any_text() : "";
    Bits bits = 0;
    if (text.size() != 2 + 2 * sizeof(Bits) || !text.starts_with("0x")) return false;
    const auto end = text.data() + text.size();
    const auto result = std::from_chars(text.data() + 2, end, bits, 16);
    if (result.ec != std::errc() || result.ptr != end) return false;
    put(bits, metadata);
    return true;
}

double float_fill(const JsonNode& fill, const ZarrMetadata& metadata)
{
    if (fill.is("NaN")) return std::numeric_limits<double>::quiet_NaN();
    if (fill.is("Infinity")) return std::numeric_limits<double>::infinity();
    if (fill.is("-Infinity")) return -std::numeric_limits<double>::infinity();
    if (!fill.is_number()) {
        const char* const bits = metadata.type == VoxelType::float32 ? ", bits such as \"0x7fc00000\""
                                                                     : ", bits such as \"0x7ff8000000000000\"";
        fill.refuse(
            sentence("a number, \"NaN\", \"Infinity\", \"-Infinity\"", metadata.version == 3 ? bits : "", " or null"));
    }
    return fill.number(any_number());
}

}  // namespace

std::vector<int64_t> read_zarr_sides(const JsonNode& node)
{
    std::vector<int64_t> sides;
    for (const JsonNode& side : node.elements(1, MAX_AXES)) sides.push_back(side.whole(1, int64_t{1} << 62));
    return sides;
}

std::vector<int64_t> read_zarr_chunk(const JsonNode& node, size_t axes)
{
    std::vector<int64_t> sides = read_zarr_sides(node);
    if (sides.size() != axes) node.refuse(sentence("as many numbers as shape has, ", axes));
    return sides;
}

void read_zarr_fill(const JsonNode& node, ZarrMetadata& metadata)
{
    // The fill value null leaves the voxels of missing chunks undefined; like other readers, this one returns 0.
    if (!node.exists() || node.is_null()) return;
    switch (metadata.stored) {
        case StoredNumber::int64: return put_whole<int64_t>(node, metadata);
        case StoredNumber::uint64: return put(uint64_t(node.whole(0, std::numeric_limits<int64_t>::max())), metadata);
        case StoredNumber::float16: {
            if (put_bits<uint16_t>(node, metadata)) return;
            const std::optional<uint16_t> half = half_of(float_fill(node, metadata));
            if (!half) node.refuse("a number that 16-bit floats hold");
            return put(*half, metadata);
        }
        case StoredNumber::plain: break;
    }
    if (const std::string text = node.dump(); text == "true" || text == "false")  // of arrays of bool
        if (metadata.type == VoxelType::uint8) return put(uint8_t(text == "true"), metadata);
    switch (metadata.type) {
        case VoxelType::uint8: return put_whole<uint8_t>(node, metadata);
        case VoxelType::int8: return put_whole<int8_t>(node, metadata);
        case VoxelType::uint16: return put_whole<uint16_t>(node, metadata);
        case VoxelType::int16: return put_whole<int16_t>(node, metadata);
        case VoxelType::uint32: return put_whole<uint32_t>(node, metadata);
        case VoxelType::int32: return put_whole<int32_t>(node, metadata);
        case VoxelType::float32: {
            if (put_bits<uint32_t>(node, metadata)) return;
            const double value = float_fill(node, metadata);
            if (std::isfinite(value) && std::abs(value) > double{std::numeric_limits<float>::max()})
                node.refuse("a number that 32-bit floats hold");
            return put(float(value), metadata);
        }
        case VoxelType::float64: {
            if (put_bits<uint64_t>(node, metadata)) return;
            return put(float_fill(node, metadata), metadata);
        }
    }
}

Json zarr_fill(const ZarrMetadata& metadata)
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

void check_zarr_chunk(const JsonNode& node, const ZarrMetadata& metadata)
{
    auto bytes = int64_t(bytes_of(metadata.type));
    for (const int64_t side : metadata.chunks) {
        if (!__builtin_mul_overflow(bytes, side, &bytes) && bytes <= MAX_CHUNK_BYTES) continue;
        node.refuse(sentence("chunks of at most ", MAX_CHUNK_BYTES >> 20, " MiB, which are decoded as a whole"));
    }
}

}  // namespace shvr
