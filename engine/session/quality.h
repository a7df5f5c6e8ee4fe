#pragma once
// Four presets that trade the time of a picture for its errors. The window offers them, and `render.quality` selects
// one. Pure functions; any thread.

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

/// Returns all qualities, from the fastest to the most exact.
std::span<const Quality> qualities();
void take(RenderSettings& render, const Quality& quality);
/// Returns the quality with exactly these settings; null if there is none.
std::optional<Quality> quality_of(const RenderSettings& render);
/// Returns the keys of `render` that a quality sets.
std::span<const std::string_view> keys_of_quality();

}  // namespace shvr
