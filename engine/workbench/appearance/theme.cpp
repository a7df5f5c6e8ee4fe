#include "engine/workbench/appearance/theme.h"

#include <algorithm>
#include <cmath>

#include "engine/base/image.h"

namespace shvr::ui {

namespace {

struct ShadeRow {
    ColorRole role;
    uint32_t dark, light;  ///< 0xrrggbb
};

/// In the order of ColorRole.
constexpr ShadeRow SHADES[] = {
    {ColorRole::text, 0xe6e6e6, 0x1a1a1a},
    {ColorRole::faint_text, 0xbdbdbd, 0x484848},
    {ColorRole::warning, 0xf5bd64, 0x6b3f00},
    {ColorRole::error, 0xffa79a, 0x97140a},
    {ColorRole::accent_text, 0x8fbcf5, 0x0b4a94},
    {ColorRole::window, 0x252525, 0xf4f4f4},
    {ColorRole::popup, 0x2b2b2b, 0xfbfbfb},
    {ColorRole::bar, 0x2e2e2e, 0xe4e4e4},
    {ColorRole::frame, 0x363636, 0xffffff},
    {ColorRole::frame_hovered, 0x3e3e3e, 0xeef3fa},
    {ColorRole::frame_active, 0x454545, 0xe0ebf8},
    {ColorRole::button, 0x3b3b3b, 0xdcdcdc},
    {ColorRole::button_hovered, 0x474747, 0xcfd8e3},
    {ColorRole::button_active, 0x284467, 0xb4cdee},
    {ColorRole::header, 0x353535, 0xdedede},
    {ColorRole::header_hovered, 0x414141, 0xd2d9e2},
    {ColorRole::header_active, 0x284467, 0xbcd2ef},
    {ColorRole::chosen, 0x29466a, 0xb9d1f0},
    {ColorRole::selection, 0x294568, 0xa9c8f2},
    {ColorRole::table_header, 0x333333, 0xdddddd},
    {ColorRole::notice, 0x5c430f, 0xffe3ad},
    {ColorRole::accent, 0x6f9fe0, 0x2f6db8},
    {ColorRole::accent_strong, 0x8fbcf5, 0x1f559c},
    {ColorRole::line, 0xe1e1e1, 0x2a2a2a},
    {ColorRole::border, 0x4d4d4d, 0xb0b0b0},
    {ColorRole::separator, 0x454545, 0xc4c4c4},
    {ColorRole::scrollbar, 0x4d4d4d, 0xbdbdbd},
    {ColorRole::scrollbar_hovered, 0x5c5c5c, 0xa6a6a6},
    {ColorRole::scrollbar_active, 0x6b6b6b, 0x8f8f8f},
    {ColorRole::chart, 0x1a1a1a, 0xffffff},
    {ColorRole::chart_bars, 0x4e4e4e, 0xc6c6c6},
    {ColorRole::chart_line, 0xe1e1e1, 0x2a2a2a},
    {ColorRole::chart_paint, 0xf0b85a, 0x8a5200},
    {ColorRole::chart_felt, 0x78c896, 0x0b6b3a},
};
static_assert(std::size(SHADES) == size_t(ColorRole::COUNT));

constexpr ColorRole TEXTS[] = {ColorRole::text, ColorRole::faint_text, ColorRole::warning, ColorRole::error,
                               ColorRole::accent_text};
constexpr ColorRole SURFACES[] = {ColorRole::window, ColorRole::popup,          ColorRole::bar,
                                  ColorRole::frame,  ColorRole::frame_hovered,  ColorRole::frame_active,
                                  ColorRole::button, ColorRole::button_hovered, ColorRole::button_active,
                                  ColorRole::header, ColorRole::header_hovered, ColorRole::header_active,
                                  ColorRole::chosen, ColorRole::selection,      ColorRole::table_header,
                                  ColorRole::notice};

double luminance(const Shade& shade)
{
    constexpr double WEIGHTS[] = {0.2126, 0.7152, 0.0722};
    double sum = 0.0;
    for (size_t i = 0; i < 3; ++i) sum += WEIGHTS[i] * srgb_decode(double(shade[i]));
    return sum;
}

}  // namespace

Shade shade_of(ColorRole role, Theme theme)
{
    const ShadeRow& row = SHADES[size_t(role)];
    const uint32_t code = theme == Theme::dark ? row.dark : row.light;
    const auto channel = [&](uint32_t shift) { return float((code >> shift) & 255u) / 255.0f; };
    return {channel(16), channel(8), channel(0)};
}

std::span<const ColorRole> text_roles()
{
    return TEXTS;
}

std::span<const ColorRole> surface_roles()
{
    return SURFACES;
}

double contrast(const Shade& a, const Shade& b)
{
    const auto [darker, lighter] = std::minmax({luminance(a), luminance(b)});
    return (lighter + 0.05) / (darker + 0.05);
}

Shade blended(const Shade& over, const Shade& below, float share)
{
    Shade mixed{};
    for (size_t i = 0; i < 3; ++i) mixed[i] = share * over[i] + (1.0f - share) * below[i];
    return mixed;
}

}  // namespace shvr::ui
