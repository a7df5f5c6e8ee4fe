#include "engine/session/quality.h"

#include <algorithm>

namespace shvr {

namespace {

constexpr Quality QUALITIES[] = {
    {.name = "draft",
     .note = "To look around in on a slow machine: about 1 of 255 levels from the reference (root mean square), "
             "27 at most. Step 1, no narrow peaks.",
     .step_voxels = 1.0,
     .opacity_limit = 0.99,  // 0.95 takes 3/4 of the time, but errors in deep fog reach 6 of 255 levels
     .detail = 0.5},
    {.name = "interactive",
     .note = "To work in, and what a new session has: about 0.2 of 255 levels from the reference, 9 at most. Step 0.5.",
     .step_voxels = 0.5,
     .opacity_limit = 1.0 - 1.0 / 1024},
    {.name = "good",
     .note = "For figures: about 0.1 of 255 levels from the reference, 1 at most. Step 0.125.",
     .step_voxels = 0.125,
     .opacity_limit = 1.0 - 1.0 / 1024},
    {.name = "reference",
     .note = "To compare with: light is integrated to about 1e-5 (measured without iso-surfaces, smooth borders and "
             "occlusion), exact sampling, rays end where nothing is left.",
     .step_voxels = 1.0,  // the largest step: integration is exact for any step
     .opacity_limit = 1.0,
     .sampling = Sampling::exact,
     .detail = 0.0,
     .exact_integral = true},
};

constexpr std::string_view KEYS[] = {"step_voxels",      "opacity_limit",  "sampling",      "detail",
                                     "skip_empty_space", "preintegration", "exact_integral"};

}  // namespace

std::span<const Quality> qualities()
{
    return QUALITIES;
}

void take(RenderSettings& render, const Quality& quality)
{
    render.step_voxels = quality.step_voxels;
    render.opacity_limit = quality.opacity_limit;
    render.sampling = quality.sampling;
    render.detail = quality.detail;
    render.skip_empty_space = quality.skip_empty_space;
    render.preintegration = quality.preintegration;
    render.exact_integral = quality.exact_integral;
}

std::optional<Quality> quality_of(const RenderSettings& render)
{
    const auto is_it = [&](const Quality& quality) {
        RenderSettings taken = render;
        take(taken, quality);
        return taken == render;
    };
    const auto found = std::ranges::find_if(QUALITIES, is_it);
    return found == std::end(QUALITIES) ? std::nullopt : std::optional(*found);
}

std::span<const std::string_view> keys_of_quality()
{
    return KEYS;
}

}  // namespace shvr
