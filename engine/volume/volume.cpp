#include "engine/volume/volume.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

constexpr double MAX_CODE = 65535.0;
constexpr double MAX_END = 0.5 * std::numeric_limits<double>::max() / 1.001;

/// All spellings, in lower case, with single spaces between words and without MetaImage's prefix "MET_".
constexpr std::pair<const char*, VoxelType> SPELLINGS[] = {
    {"uint8", VoxelType::uint8},
    {"uint8_t", VoxelType::uint8},
    {"uchar", VoxelType::uint8},
    {"unsigned char", VoxelType::uint8},
    {"byte", VoxelType::uint8},
    {"int8", VoxelType::int8},
    {"int8_t", VoxelType::int8},
    {"char", VoxelType::int8},
    {"signed char", VoxelType::int8},
    {"uint16", VoxelType::uint16},
    {"uint16_t", VoxelType::uint16},
    {"ushort", VoxelType::uint16},
    {"ushort_12", VoxelType::uint16},  // side-cars: 12 bits stored in 16
    {"unsigned short", VoxelType::uint16},
    {"unsigned short int", VoxelType::uint16},
    {"int16", VoxelType::int16},
    {"int16_t", VoxelType::int16},
    {"short", VoxelType::int16},
    {"short int", VoxelType::int16},
    {"signed short", VoxelType::int16},
    {"signed short int", VoxelType::int16},
    {"uint32", VoxelType::uint32},
    {"uint32_t", VoxelType::uint32},
    {"uint", VoxelType::uint32},
    {"unsigned int", VoxelType::uint32},
    {"int32", VoxelType::int32},
    {"int32_t", VoxelType::int32},
    {"int", VoxelType::int32},
    {"signed int", VoxelType::int32},
    {"float32", VoxelType::float32},
    {"float", VoxelType::float32},
    {"float64", VoxelType::float64},
    {"double", VoxelType::float64},
};

std::string plain_spelling(const std::string& name)
{
    std::string plain;
    for (const char character : name) {
        const auto byte = static_cast<unsigned char>(character);
        if (std::isspace(byte) != 0) {
            if (!plain.empty() && plain.back() != ' ') plain += ' ';
        } else {
            plain += char(std::tolower(byte));
        }
    }
    if (!plain.empty() && plain.back() == ' ') plain.pop_back();
    return plain.starts_with("met_") ? plain.substr(4) : plain;
}

}  // namespace

size_t bytes_of(VoxelType type)
{
    switch (type) {
        case VoxelType::uint8:
        case VoxelType::int8: return 1;
        case VoxelType::uint16:
        case VoxelType::int16: return 2;
        case VoxelType::uint32:
        case VoxelType::int32:
        case VoxelType::float32: return 4;
        case VoxelType::float64: return 8;
    }
    SHVR_CHECK(false, "voxel type ", int(type));
    return 0;
}

const char* name_of(VoxelType type)
{
    switch (type) {
        case VoxelType::uint8: return "uint8";
        case VoxelType::int8: return "int8";
        case VoxelType::uint16: return "uint16";
        case VoxelType::int16: return "int16";
        case VoxelType::uint32: return "uint32";
        case VoxelType::int32: return "int32";
        case VoxelType::float32: return "float32";
        case VoxelType::float64: return "float64";
    }
    SHVR_CHECK(false, "voxel type ", int(type));
    return "";
}

const char* name_of(Provenance provenance)
{
    return provenance == Provenance::file ? "file" : provenance == Provenance::given ? "given" : "assumed";
}

bool states_place(const VolumeInfo& info)
{
    return !info.frame.empty() || info.origin != glm::dvec3(0.0) || info.directions != glm::dmat3(1.0);
}

bool are_axes(const glm::dmat3& directions)
{
    constexpr double TOLERANCE = 1e-6, FLATTEST = 1e-6;
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(glm::length(directions[axis]) - 1.0) < TOLERANCE)) return false;
    return glm::determinant(directions) >= FLATTEST;
}

bool is_float(VoxelType type)
{
    return type == VoxelType::float32 || type == VoxelType::float64;
}

std::optional<VoxelType> voxel_type_of(const std::string& name)
{
    const std::string plain = plain_spelling(name);
    for (const auto& [spelling, type] : SPELLINGS) {
        if (plain == spelling) return type;
    }
    return {};
}

int64_t voxel_count(const VolumeInfo& info)
{
    int64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t side = info.size[axis];
        if (side < 1 || side > MAX_SIDE) {
            fail(info.name, ": size along ", "xyz"[axis], " is ", side, "; expected 1 to ", MAX_SIDE);
        }
        if (__builtin_mul_overflow(count, side, &count)) {
            fail(info.name, ": size ", info.size.x, "x", info.size.y, "x", info.size.z,
                 " gives more voxels than 63 bits count; expected fewer");
        }
    }
    return count;
}

uint32_t IntensityWindow::threshold_code(double threshold) const
{
    // Searches with `intensity_of`, with which callers compare, so that rounding in `code_of` has no influence.
    uint32_t below = 0;
    uint32_t above = 65536;
    while (below < above) {
        const uint32_t middle = (below + above) / 2;
        if (intensity_of(middle) >= threshold) {
            above = middle;
        } else {
            below = middle + 1;
        }
    }
    return below;
}

IntensityWindow window_for(VoxelType type, double minimum, double maximum)
{
    if (type == VoxelType::uint8) return {0.0, 257.0};
    if (type == VoxelType::int8) return {-128.0, 257.0};
    if (!is_float(type)) {
        const double lower = std::floor(minimum);
        const double range = std::ceil(maximum) - lower;
        const bool is_exact = range <= MAX_CODE || type == VoxelType::uint16 || type == VoxelType::int16;
        if (is_exact) return {lower, std::floor(MAX_CODE / std::clamp(range, 1.0, MAX_CODE))};
    }
    // The difference of two doubles can be infinite, and so can the inverse of their difference.
    const double lower = std::clamp(minimum, -MAX_END, MAX_END);
    const double range = std::clamp(maximum, -MAX_END, MAX_END) - lower;
    return {lower, range > 0.0 ? std::min(MAX_CODE / range, MAX_END) : MAX_CODE};
}

IntensityWindow window_for(VoxelType type, const VolumeStatistics& statistics)
{
    const bool is_partial = statistics.measured_level > 0 || statistics.sampled_voxels > 0;
    if (is_partial && type == VoxelType::uint16) return window_for(type, 0.0, 65535.0);
    if (is_partial && type == VoxelType::int16) return window_for(type, -32768.0, 32767.0);
    constexpr double MAX_WIDENING = 5.0;
    const auto [lower, upper] = statistics.range();
    // Computes halves, since the difference of two doubles can overflow to infinity.
    const double half_all = 0.5 * statistics.maximum - 0.5 * statistics.minimum, half = 0.5 * upper - 0.5 * lower;
    const bool is_exact = !is_float(type) && 2.0 * half_all <= MAX_CODE;
    if (is_exact || half_all <= MAX_WIDENING * half) return window_for(type, statistics.minimum, statistics.maximum);
    return window_for(type, lower, upper);
}

bool has_exact_codes(VoxelType type, const VolumeStatistics& statistics)
{
    if (bytes_of(type) <= 2) return true;  // the window then covers all values, or the whole range of the type
    const bool is_partial = statistics.measured_level > 0 || statistics.sampled_voxels > 0;
    return !is_float(type) && !is_partial && statistics.maximum - statistics.minimum <= MAX_CODE;
}

}  // namespace shvr
