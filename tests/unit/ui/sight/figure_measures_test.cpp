// Measurements in figures and in the frames of movies.

#include "engine/workbench/sight/figure_measures.h"

#include <doctest/doctest.h>

#include "engine/look/panes.h"
#include "engine/workbench/sight/figure_elements.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

std::vector<TextImage> blocks(std::span<const std::string> texts, double pixels)
{
    std::vector<TextImage> images;
    for (const std::string& text : texts) {
        const glm::ivec2 size(int(0.5 * pixels) * int(text.size()), int(pixels));
        images.push_back({size, std::vector<uint8_t>(size_t(size.x) * size_t(size.y), 255)});
    }
    return images;
}

/// Six lines like spokes around the middle of 100^3 voxels, as a camera turns around it.
class Turning {
public:
    Turning()
    {
        volume_.size = {100, 100, 100};
        for (int i = 0; i < 6; ++i) {
            const double angle = glm::radians(60.0 * i);
            const glm::dvec3 way(std::cos(angle), std::sin(angle), 0.2 * i - 0.5);
            session_.measurements.push_back({{middle_ + 15.0 * way, middle_ + 40.0 * way}});
        }
    }

    /// Returns how often a label moves by more than three lines of text against its line, from frame to frame of a
    /// whole turn.
    int jumps(FigureMemory* memory)
    {
        int found = 0;
        std::vector<glm::dvec2> before;
        for (int frame = 0; frame < 120; ++frame) {
            const std::vector<glm::dvec2> offsets = offsets_in(3.0 * frame, memory);
            for (size_t i = 0; i < before.size(); ++i) found += glm::distance(before[i], offsets[i]) > 42.0;
            before = offsets;
        }
        return found;
    }

private:
    std::vector<glm::dvec2> offsets_in(double degrees, FigureMemory* memory)
    {
        const Camera front = camera_looking("front", volume_);
        const Camera camera = orbited(front, front.target, degrees, 0.0);
        const std::vector<Pane> panes = panes_of(session_.view, camera, {480, 360}, volume_, middle_);
        std::vector<std::string> left_out;
        const Figure figure = figure_of({.has_measurements = true, .text_pixels = 14.0},
                                        {session_, volume_, panes, {}, memory}, blocks, left_out);
        CHECK(left_out == std::vector<std::string>());
        const std::vector<Stamp>& stamps = figure.parts.front().stamps;  // a rim before each text
        REQUIRE(stamps.size() == 2 * session_.measurements.size());
        std::vector<glm::dvec2> offsets;
        for (size_t i = 0; i < session_.measurements.size(); ++i) {
            const std::vector<glm::dvec3>& ends = session_.measurements[i].points;
            const auto at = project(camera, {480, 360}, 0.5 * (ends[0] + ends[1]));
            REQUIRE(at.has_value());
            offsets.push_back(glm::dvec2(stamps[2 * i + 1].begin) - at->pixel);
        }
        return offsets;
    }

    VolumeInfo volume_{.name = "volume"};
    Session session_;
    glm::dvec3 middle_{50.0};
};

}  // namespace

TEST_CASE("a label of a measurement that is wider than the picture is left out, with a sentence")
{
    VolumeInfo volume{.name = "volume"};
    volume.size = {100, 100, 100};
    volume.unit = "voxel";
    Session session;
    session.measurements.push_back({{glm::dvec3(10.0, 50.0, 50.0), glm::dvec3(90.0, 50.0, 50.0)}});
    const auto labels = [&](uint32_t side, std::vector<std::string>& left_out) {
        const std::vector<Pane> panes =
            panes_of(session.view, camera_looking("front", volume), {side, side}, volume, glm::dvec3(50.0));
        const Figure figure = figure_of({.has_measurements = true, .text_pixels = 10.0},
                                        {session, volume, panes, {}, nullptr}, blocks, left_out);
        CHECK_FALSE(figure.parts.front().strokes.empty());
        return figure.parts.front().stamps.size() / 2;  // a rim before each text
    };
    std::vector<std::string> small, large;
    CHECK(labels(47, small) == 0);  // "80 voxels" takes 45 pixels and a margin
    CHECK(small == std::vector<std::string>{"1 label of measurements is left out: the picture is too small for it"});
    CHECK(labels(300, large) == 1);
    CHECK(large.empty());
}

TEST_CASE("labels of measurements stay where they are in the frames of a movie, which are the same each time")
{
    Turning turning;
    FigureMemory memory, again;
    const int without = turning.jumps(nullptr), with = turning.jumps(&memory);
    CAPTURE(without);
    CAPTURE(with);
    CHECK(without > 40);
    CHECK(2 * with < without);
    CHECK(turning.jumps(&again) == with);
    CHECK(memory == again);
}
