#pragma once
// Edits colours stored in linear light as sRGB. Between Window::begin_ui and Window::present, main thread.

#include <imgui/imgui.h>
#include <glm/glm.hpp>

namespace shvr::ui {

ImVec4 encoded(const glm::dvec3& linear, float alpha = 1.0f);
glm::dvec3 decoded(const float* srgb);
/// Draws a coloured square that opens a colour picker, without a visible label. `has_numbers`: its three channels stand
/// before it. Returns whether the colour was changed.
bool color_field(const char* label, glm::dvec3& linear, bool has_numbers = false);

}  // namespace shvr::ui
