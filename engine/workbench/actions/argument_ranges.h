#pragma once
// Ranges of arguments of actions, and groups of arguments that several actions share.

#include <optional>

#include <glm/glm.hpp>

#include "engine/base/json.h"

namespace shvr::ui {

inline const NumberRange DEGREES{-36000.0, 36000.0}, PIXELS{-1e6, 1e6}, FACTOR{1e-6, 1e6}, SHARES{-100.0, 100.0};
inline const NumberRange VOXELS{-1e12, 1e12}, DISTANCES{0.0, 1e15}, SPACINGS{1e-12, 1e12}, NODE_STEPS{0.5, 1000.0};

template <class Visitor>
void pane_field(Visitor& f, size_t& pane)
{
    f.whole("pane", pane, 0, 15, {"number of the pane, from 0"});
}

template <class Visitor>
void pixel_field(Visitor& f, const char* name, glm::dvec2& pixel)
{
    std::optional<glm::dvec2> value = pixel;
    f.numbers(name, value, PIXELS, {"pixels of the pane, right and down"});
    pixel = value.value_or(pixel);
}

}  // namespace shvr::ui
