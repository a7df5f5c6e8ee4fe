#include "engine/formats/zarr/ome_place.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

VolumeInfo placed(const JsonNode& placement, VolumeInfo info)
{
    if (!placement.is_object()) placement.refuse("an object with frame, directions and origin");
    const JsonNode directions = placement["directions"];
    const std::vector<JsonNode> rows = directions.elements(3, 3);
    for (int axis = 0; axis < 3; ++axis) info.directions[axis] = rows[size_t(axis)].vector(any_number());
    if (!are_axes(info.directions)) directions.refuse("three right-handed vectors of length 1");
    info.origin = placement["origin"].vector(any_number());
    info.frame = printable(placement["frame"].any_text());
    return info;
}

}  // namespace

glm::dvec3 ome_translation(const VolumeInfo& info)
{
    return glm::inverse(info.directions) * info.origin;
}

void read_ome_place(const JsonNode& attributes, const std::optional<glm::dvec3>& translation, VolumeInfo& info)
{
    info.origin = translation.value_or(glm::dvec3(0.0));
    const JsonNode placement = attributes[OME_PLACEMENT];
    if (!placement.exists()) return;
    try {
        info = placed(placement, std::move(info));
    } catch (const Error& error) {
        info.warnings.push_back(sentence(error.what(), "; it is left out"));
        return;
    }
    if (!translation) return;
    // The two were rounded independently.
    const glm::dvec3 apart = glm::abs(ome_translation(info) - *translation);
    const double far = 1e-12 * std::max({glm::length(*translation), info.spacing.x, info.spacing.y, info.spacing.z});
    if (!glm::all(glm::lessThanEqual(apart, glm::dvec3(far)))) info.origin = info.directions * *translation;
}

}  // namespace shvr
