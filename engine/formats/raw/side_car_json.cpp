// Our own side-car; size and type are required:
// {"size": [x,y,z], "type": "int16", "endian": "little", "offset": 0, "spacing": [x,y,z], "unit": "um"}

#include <array>
#include <limits>

#include "engine/base/json.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/raw/side_cars.h"
#include "engine/volume/grid.h"

namespace shvr {

SideCar read_json_side_car(const JsonDocument& document, const std::filesystem::path& raw)
{
    constexpr double SMALLEST = std::numeric_limits<double>::denorm_min();
    constexpr double LARGEST = std::numeric_limits<double>::max();
    const JsonNode root = document.root();
    root.allow({"size", "type", "endian", "offset", "spacing", "unit"});
    SideCar found{.voxels = {.file = raw, .big_endian = {}}};
    const std::array<std::string_view, 2> orders{"little", "big"};
    if (const JsonNode endian = root["endian"]; endian.exists()) found.voxels.big_endian = endian.choice(orders) == 1;
    found.voxels.offset_bytes = root["offset"].whole(found.voxels.offset_bytes, 0, int64_t{1} << 62);
    std::optional<glm::dvec3> spacing;
    if (const JsonNode node = root["spacing"]; node.exists())
        spacing = node.vector({SMALLEST, LARGEST, "a finite number above 0"});
    std::optional<std::string> unit;
    if (const JsonNode node = root["unit"]; node.exists()) unit = node.any_text();
    found.info.size = root["size"].size(MAX_SIDE);
    found.info.type =
        root["type"].parsed([](const std::string& name) { return voxel_type_of(name); }, VOXEL_TYPE_NAMES);
    apply_spacing(found.info, spacing, unit, "voxel");
    return found;
}

}  // namespace shvr
