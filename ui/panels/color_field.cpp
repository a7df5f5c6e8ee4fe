#include "ui/panels/color_field.h"

#include <algorithm>

#include "engine/base/image.h"

namespace shvr::ui {

ImVec4 encoded(const glm::dvec3& linear, float alpha)
{
    const auto encode = [](double value) { return float(srgb_encode(std::clamp(value, 0.0, 1.0))); };
    return {encode(linear.x), encode(linear.y), encode(linear.z), alpha};
}

glm::dvec3 decoded(const float* srgb)
{
    const auto decode = [](float value) { return std::clamp(srgb_decode(double(value)), 0.0, 1.0); };
    return {decode(srgb[0]), decode(srgb[1]), decode(srgb[2])};
}

bool color_field(const char* label, glm::dvec3& linear, ImGuiColorEditFlags flags)
{
    ImVec4 color = encoded(linear);
    if (!ImGui::ColorEdit3(label, &color.x, flags)) return false;
    linear = decoded(&color.x);
    return true;
}

}  // namespace shvr::ui
