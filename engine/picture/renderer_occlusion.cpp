// What the renderer does about ambient occlusion: whether there is any, what it depends on, and the next slice of it.

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
        volume_->want_around({});
        return std::nullopt;
    }
    if (!volume_->has_view()) return std::nullopt;
    const Occlusion::Look look = occlusion_look(session);
    occlusion_.look(look, *volume_, mask_);
    volume_->want_around(occlusion_.reach());
    if (!occlusion_.is_due()) return std::nullopt;
    volume_->look_by(look.visibility);
    OcclusionSlice slice;
    const std::optional<MaskBinding> mask = mask_.import(slice.graph);
    const VolumeBinding volume = volume_->prepare(slice.graph, mask_, mask, false);
    slice.renewed = occlusion_.next(slice.graph, volume, mask, camera.eye / volume_->info().spacing, most);
    return slice;
}

}  // namespace shvr
