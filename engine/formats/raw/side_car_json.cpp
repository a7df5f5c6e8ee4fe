// Our own side-car; size and type are required:
// {"size": [x,y,z], "type": "int16", "endian": "little", "offset": 0, "spacing": [x,y,z], "unit": "um"}

#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/raw/side_cars.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

[[noreturn]] void refuse_key(const fs::path& path, const char* key, const Json& value, const char* expected)
{
    const std::string found = value.dump(-1, ' ', true, Json::error_handler_t::replace);
    fail(path.string(), ": ", key, " is ", found.size() <= 60 ? found : found.substr(0, 60) + "...", "; expected ",
         expected);
}

glm::dvec3 json_spacing(const fs::path& path, const Json& value)
{
    constexpr const char* EXPECTED = "three finite numbers above 0";
    if (!value.is_array() || value.size() != 3) refuse_key(path, "spacing", value, EXPECTED);
    glm::dvec3 spacing(1.0);
    for (int axis = 0; axis < 3; ++axis) {
        const Json& number = value[static_cast<size_t>(axis)];
        if (!number.is_number()) refuse_key(path, "spacing", value, EXPECTED);
        spacing[axis] = number.get<double>();
        if (!std::isfinite(spacing[axis]) || !(spacing[axis] > 0.0)) refuse_key(path, "spacing", value, EXPECTED);
    }
    return spacing;
}

Size3 json_size(const fs::path& path, const Json& value)
{
    constexpr const char* EXPECTED = "three whole numbers from 1 to 1048576";
    if (!value.is_array() || value.size() != 3) refuse_key(path, "size", value, EXPECTED);
    Size3 size(0);
    for (int axis = 0; axis < 3; ++axis) {
        const Json& side = value[static_cast<size_t>(axis)];
        if (!side.is_number_unsigned() || side.get<uint64_t>() < 1 || side.get<uint64_t>() > uint64_t{LARGEST_SIDE}) {
            refuse_key(path, "size", value, EXPECTED);
        }
        size[axis] = side.get<int64_t>();
    }
    return size;
}

std::string json_text(const fs::path& path, const char* key, const Json& value, const char* expected)
{
    if (!value.is_string()) refuse_key(path, key, value, expected);
    return value.get<std::string>();
}

}  // namespace

SideCar read_json_side_car(const fs::path& path, const Json& document, const fs::path& raw)
{
    SideCar found{.voxels = {.file = raw, .big_endian = {}}};
    std::optional<glm::dvec3> spacing;
    std::optional<std::string> unit;
    for (const auto& [key, value] : document.items()) {
        if (key == "size") {
            found.info.size = json_size(path, value);
        } else if (key == "type") {
            const std::optional<VoxelType> type = voxel_type_of(json_text(path, "type", value, VOXEL_TYPE_NAMES));
            if (!type) refuse_key(path, "type", value, VOXEL_TYPE_NAMES);
            found.info.type = *type;
        } else if (key == "endian") {
            constexpr const char* EXPECTED = "\"little\" or \"big\"";
            const std::string endian = json_text(path, "endian", value, EXPECTED);
            if (endian != "little" && endian != "big") refuse_key(path, "endian", value, EXPECTED);
            found.voxels.big_endian = endian == "big";
        } else if (key == "offset") {
            constexpr uint64_t MOST = uint64_t{1} << 62;
            if (!value.is_number_unsigned() || value.get<uint64_t>() > MOST) {
                refuse_key(path, "offset", value, "a whole number of bytes, 0 or more");
            }
            found.voxels.offset_bytes = value.get<int64_t>();
        } else if (key == "spacing") {
            spacing = json_spacing(path, value);
        } else if (key == "unit") {
            unit = json_text(path, "unit", value, "a text");
        } else {
            fail(path.string(), ": unknown key ", in_quotes(key),
                 "; expected size, type, endian, offset, spacing or unit");
        }
    }
    for (const char* key : {"size", "type"}) {
        if (!document.contains(key)) fail(path.string(), ": ", key, " is missing; expected size and type");
    }
    apply_spacing(found.info, spacing, unit, "voxel");
    return found;
}

}  // namespace shvr
