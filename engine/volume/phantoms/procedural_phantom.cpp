// Phantoms made from the kinds of procedural volumes in procedural/.

#include "engine/base/error.h"
#include "engine/volume/phantoms/phantom_model.h"

namespace shvr {

namespace {

/// A volume in which the value of a voxel is the colour group at its centre.
class GroupSource final : public VolumeSource {
public:
    GroupSource(VolumeInfo volume, std::function<uint8_t(const glm::dvec3&)> group)
        : VolumeSource(of_groups(std::move(volume))), group_(std::move(group))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        size_t at = 0;
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x)
                    voxels[at++] = std::byte(group_(glm::dvec3(x, y, z) + 0.5));
    }

private:
    static VolumeInfo of_groups(VolumeInfo volume)
    {
        volume.type = VoxelType::uint8;
        return volume;
    }

    std::function<uint8_t(const glm::dvec3&)> group_;
};

std::map<std::string, uint8_t> sections_of(const std::string& kind)
{
    if (kind == "chirality") return {{"x arm", 1}, {"y arm", 2}, {"z arm", 3}, {"ball", 4}};
    if (kind == "tubes") return {{"bundle", 1}, {"branch", 2}};
    if (kind == "speckles") return {{"speckle", 1}};
    return {};
}

}  // namespace

Phantom make_procedural_phantom(const PhantomSpec& spec)
{
    const ProceduralSpec procedural{.kind = spec.kind, .size = spec.size, .seed = spec.seed, .type = spec.type};
    Phantom phantom{.volume = open_procedural(procedural)};
    std::optional<ProceduralTruth> truth = procedural_truth(procedural);
    if (!truth) return phantom;
    phantom.mask = std::make_unique<GroupSource>(phantom.volume->info(), std::move(truth->group));
    phantom.nodes = std::move(truth->nodes);
    phantom.links = std::move(truth->links);
    phantom.sections = sections_of(spec.kind);
    return phantom;
}

}  // namespace shvr
