// What the renderer does about ambient occlusion: whether there is any, what it depends on, and the next slice of it.

#include <utility>

#include "engine/picture/renderer.h"

namespace shvr {

bool shows_occlusion(const Light& light)
{
    return light.shaded && light.ambient > 0.0 && light.occlusion.strength > 0.0;
}

Occlusion::Look Renderer::occlusion_look(const Session& session)
{
    const OcclusionSettings& settings = session.light.occlusion;
    Occlusion::Look look{.function = session.transfer_function,
                         .visibility = visibility_of(session),
                         .cut = session.cut,
                         .radius = settings.radius,
                         .rays = settings.rays,
                         .full_sphere = settings.full_sphere,
                         .gradient_fade = gradient_fade_codes(session)};
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup of_group = group_of(session.groups, uint8_t(group));
        look.groups[group] = of_group.visible ? of_group.opacity : 0.0;
    }
    return look;
}

/// Of the bricks that rays came by, those around them, too: light comes from there.
void Renderer::want_around()
{
    if (!paged_ || std::exchange(reached_revision_, paged_->reached_revision()) == paged_->reached_revision()) return;
    std::unordered_set<BrickKey, BrickKeyHash> keys;
    for (const BrickKey& key : paged_->reached_bricks()) {
        const int reach = occlusion_.reach(key.level);
        const glm::ivec3 counts = brick_counts(size_of_level(volume_->info().size, key.level));
        const glm::ivec3 first = glm::max(key.brick - reach, 0), last = glm::min(key.brick + reach, counts - 1);
        for (int z = first.z; z <= last.z; ++z)
            for (int y = first.y; y <= last.y; ++y)
                for (int x = first.x; x <= last.x; ++x) keys.insert({key.level, {x, y, z}});
    }
    paged_->want_around(std::move(keys));
}

/// Whether ambient occlusion is wanted and has room. Where it has none, that is said once, and pictures go without until
/// it is switched off, or another volume comes.
bool Renderer::draws_occlusion(const Session& session)
{
    if (!shows_occlusion(session.light)) {
        occlusion_has_no_room_ = false;
        return false;
    }
    if (occlusion_has_no_room_) return false;
    if (occlusion_.exists_for(*volume_)) return true;
    try {
        occlusion_.look(occlusion_look(session), *volume_, mask_);
    } catch (const Error& error) {
        occlusion_.clear();
        occlusion_has_no_room_ = true;
        messages_.push_back(std::string("ambient occlusion is left out; ") + error.what());
    }
    return !occlusion_has_no_room_;
}

std::optional<Renderer::OcclusionSlice> Renderer::next_occlusion(const Session& session, const Camera& camera,
                                                                 const Occlusion::Most& most)
{
    if (!draws_occlusion(session)) {
        occlusion_.clear();
        reached_revision_ = 0;
        if (paged_) paged_->want_around({});
        return std::nullopt;
    }
    if (paged_ && !paged_->tree()) return std::nullopt;
    occlusion_.look(occlusion_look(session), *volume_, mask_);
    want_around();
    if (!occlusion_.is_due()) return std::nullopt;
    OcclusionSlice slice;
    std::optional<MaskBinding> mask;
    const VolumeBinding volume = import_prepared(slice.graph, session, mask, false);
    slice.renewed = occlusion_.next(slice.graph, volume, mask, camera.eye / volume_->info().spacing, most);
    return slice;
}

}  // namespace shvr
