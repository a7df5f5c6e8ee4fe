#include "engine/look/stamps.h"

#include <algorithm>
#include <cmath>

namespace shvr {

namespace {

/// Calls `take` with x, y and coverage for each pixel of a stamp that lies inside both `pane` and `rows`.
template <class Take>
void for_each_covered(const Stamp& stamp, const PixelBox& pane, const PixelBox& rows, Take take)
{
    const glm::ivec2 origin = glm::ivec2(pane.begin) + stamp.begin;
    const glm::ivec2 begin = glm::max(origin, glm::ivec2(rows.begin));
    const glm::ivec2 end = glm::min(origin + stamp.pixels, glm::ivec2(rows.end));
    for (int y = begin.y; y < end.y; ++y)
        for (int x = begin.x; x < end.x; ++x) {
            const glm::ivec2 at = glm::ivec2(x, y) - origin;
            const uint8_t covered = stamp.coverage[size_t(at.x) + size_t(stamp.pixels.x) * size_t(at.y)];
            if (covered > 0) take(size_t(x), size_t(y), covered / 255.0);
        }
}

}  // namespace

Stamp rim_of(const Stamp& ink, int width, const glm::dvec3& color)
{
    constexpr int OPAQUE = 255, RIM = 200;
    Stamp rim{.begin = ink.begin - width, .pixels = ink.pixels + 2 * width, .coverage{}, .color = color};
    rim.coverage.assign(size_t(rim.pixels.x) * size_t(rim.pixels.y), 0);
    for (int y = 0; y < ink.pixels.y; ++y)
        for (int x = 0; x < ink.pixels.x; ++x) {
            const int covered = ink.coverage[size_t(x) + size_t(ink.pixels.x) * size_t(y)] * RIM / OPAQUE;
            for (int dy = 0; covered > 0 && dy <= 2 * width; ++dy)
                for (int dx = 0; dx <= 2 * width; ++dx) {
                    uint8_t& pixel = rim.coverage[size_t(x + dx) + size_t(rim.pixels.x) * size_t(y + dy)];
                    pixel = std::max(pixel, uint8_t(covered));
                }
        }
    return rim;
}

void draw_stamps(ImageF& image, std::span<const Stamp> stamps, const PixelBox& pane, uint32_t first_row)
{
    PixelBox rows = pane;
    rows.begin.y = std::max(rows.begin.y, first_row);
    rows.end.y = std::min(rows.end.y, first_row + uint32_t(image.height));
    for (const Stamp& stamp : stamps)
        for_each_covered(stamp, pane, rows, [&](size_t x, size_t y, double covered) {
            float* const pixel = &image.rgba[4 * (x + size_t(image.width) * (y - first_row))];
            for (int c = 0; c < 4; ++c)
                pixel[c] = float(pixel[c] + covered * ((c < 3 ? stamp.color[c] : 1.0) - pixel[c]));
        });
}

void draw_stamps(Image8& image, std::span<const Stamp> stamps, const PixelBox& pane)
{
    for (const Stamp& stamp : stamps)
        for_each_covered(stamp, pane, pane, [&](size_t x, size_t y, double covered) {
            uint8_t* const pixel = &image.rgba[4 * (x + size_t(image.width) * y)];
            for (int c = 0; c < 3; ++c) {
                const double light = glm::mix(srgb_decode(pixel[c] / 255.0), stamp.color[c], covered);
                pixel[c] = uint8_t(std::lround(255.0 * srgb_encode(std::clamp(light, 0.0, 1.0))));
            }
        });
}

}  // namespace shvr
