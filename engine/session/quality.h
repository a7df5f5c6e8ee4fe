#pragma once
// Four trade-offs between a picture's time and its errors, as data: offered by the window, set by `render.quality`.
// Pure; any thread.

#include <optional>
#include <span>
#include <string_view>

#include "engine/look/settings.h"

namespace shvr {

struct Quality {
    const char* name = "";
    const char* note = "";  ///< the quality's purpose and errors (MEASURED.md)
    double step_voxels = 0.5;
    double opacity_limit = 1.0;
    Sampling sampling = Sampling::automatic;
    double detail = 1.0;
    bool skip_empty_space = true;
    bool preintegration = false;
    bool exact_integral = false;
};

/// All qualities, from the fastest to the most exact.
std::span<const Quality> qualities();
void take(RenderSettings& render, const Quality& quality);
/// The quality with exactly these settings; null if the user chose others.
std::optional<Quality> quality_of(const RenderSettings& render);
/// The keys of `render` that a quality sets.
std::span<const std::string_view> keys_of_quality();

}  // namespace shvr
