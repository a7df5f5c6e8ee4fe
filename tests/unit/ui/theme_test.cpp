#include "engine/workbench/appearance/theme.h"

#include <doctest/doctest.h>

#include "engine/base/error.h"

using namespace shvr;
using namespace shvr::ui;

TEST_CASE("Contrast goes from 1 to 21")
{
    const Shade white{1, 1, 1}, black{0, 0, 0}, grey{119.0f / 255, 119.0f / 255, 119.0f / 255};
    CHECK(contrast(white, black) == doctest::Approx(21.0));
    CHECK(contrast(black, white) == doctest::Approx(21.0));
    CHECK(contrast(grey, grey) == doctest::Approx(1.0));
    CHECK(contrast(white, grey) == doctest::Approx(4.478).epsilon(1e-3));  // WCAG's example: #777777 on white
}

TEST_CASE("Every text can be read on every surface, in both themes, greyed or not")
{
    for (const Theme theme : {Theme::dark, Theme::light})
        for (const ColorRole text : text_roles())
            for (const ColorRole surface : surface_roles()) {
                CAPTURE(int(theme));
                CAPTURE(int(text));
                CAPTURE(int(surface));
                const Shade letters = shade_of(text, theme), below = shade_of(surface, theme);
                CHECK(contrast(letters, below) >= MIN_TEXT_CONTRAST);
                // A greyed widget is drawn half clear, surface and letters alike.
                const Shade window = shade_of(ColorRole::window, theme);
                const Shade grey_below = blended(below, window, DISABLED_SHARE);
                if (text == ColorRole::text)
                    CHECK(contrast(blended(letters, grey_below, DISABLED_SHARE), grey_below) >= MIN_TEXT_CONTRAST);
            }
}

TEST_CASE("Signs and curves stand out from what they are drawn on")
{
    constexpr double MIN_SIGN_CONTRAST = 3.0;  // WCAG 2.1, 1.4.11
    for (const Theme theme : {Theme::dark, Theme::light}) {
        const auto of = [&](ColorRole a, ColorRole b) { return contrast(shade_of(a, theme), shade_of(b, theme)); };
        for (const ColorRole surface : {ColorRole::window, ColorRole::bar, ColorRole::frame, ColorRole::chosen}) {
            CAPTURE(int(surface));
            CHECK(of(ColorRole::accent, surface) >= MIN_SIGN_CONTRAST);
            CHECK(of(ColorRole::accent_strong, surface) >= MIN_SIGN_CONTRAST);
            CHECK(of(ColorRole::line, surface) >= MIN_SIGN_CONTRAST);
        }
        for (const ColorRole line : {ColorRole::chart_line, ColorRole::chart_paint, ColorRole::chart_felt})
            CHECK(of(line, ColorRole::chart) >= MIN_TEXT_CONTRAST);
    }
}
