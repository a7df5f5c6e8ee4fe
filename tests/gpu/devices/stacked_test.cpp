// Atlases of several images, on devices of which one holds too few bricks (tests/layers/records.h).

#include <array>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/annotator.h"
#include "tests/gpu/devices/on_record.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};

}  // namespace

TEST_CASE("paged bricks fill more images than one, to the bits of bricks in one")
{
    Session session = plain_session({{0.0, RED, 0.002}, {255.0, BLUE, 0.01}}, {40, 30});  // rays come by all bricks
    session.light.shaded = true;
    session.render.detail = 0.0;
    session.render.paging = Paging::always;
    // 512 bricks, and coarser ones; the images of these devices hold 343 and 320.
    const std::shared_ptr<const VolumeSource> source =
        open_procedural({.kind = "tubes", .size = {250, 250, 250}, .seed = 5});
    const Camera camera = camera_looking("right", source->info());
    const PaintOp op{.brush = Brush::fill,
                     .group = 3,
                     .threshold = 60.0,
                     .radius_voxels = 30.0,
                     .path = {{70, 60, 60}, {180, 170, 200}}};
    struct Drawn {
        ImageF plain, painted, lit;
        std::array<int64_t, 256> voxels{};
    };
    const auto drawn = [&](Renderer& renderer, bool is_stacked) {
        renderer.load(source, BYTES, session.render);
        Drawn made{.plain = renderer.render(session, camera).image, .painted = {}, .lit = {}};
        const DeviceVolume::Counts counts = renderer.volume().counts().value();
        CHECK(counts.resident > 512);
        CHECK(counts.evictions == 0);
        FrameGraph graph;
        CHECK(renderer.volume().atlas(graph).more_atlases.empty() != is_stacked);
        Session lit = session;
        lit.light.occlusion = {.strength = 0.9, .radius = 6.0, .rays = 8};
        const Picture picture = renderer.render(lit, camera);
        for (const std::string& warning : picture.warnings) MESSAGE(warning);
        if (picture.warnings.empty()) made.lit = picture.image;
        Annotator annotator(renderer);
        annotator.paint(op);
        made.voxels = annotator.document().mask.voxels_by_group();
        made.painted = renderer.render(session, camera).image;
        return made;
    };
    for (const auto& [record, sampling] :
         {std::pair{"minimum", Sampling::exact}, {"filters", Sampling::exact}, {"filters", Sampling::hardware}}) {
        CAPTURE(std::string(record));
        CAPTURE(int(sampling));
        session.render.sampling = sampling;
        Renderer plain({.device = {.validation = true}, .threads = 1});
        const Drawn expected = drawn(plain, false);
        CHECK(expected.voxels[3] > 1000);
        CHECK(!expected.lit.rgba.empty());
        On device(record);
        const Drawn seen = drawn(*device, true);
        // A filter is asked for other places of the texture.
        const auto is_same = [&](const ImageF& a, const ImageF& b) {
            return sampling == Sampling::exact ? different_bits(a, b) == 0
                                               : compare_pixels(to_image8(a), to_image8(b)).max_abs <= 1.0;
        };
        CHECK(is_same(seen.plain, expected.plain));
        CHECK(is_same(seen.painted, expected.painted));
        CHECK(seen.voxels == expected.voxels);
        CHECK(different_bits(seen.painted, seen.plain) > 0);
        // The light's images are too large for the first device, which says so.
        CHECK(seen.lit.rgba.empty() == (std::string(record) == "minimum"));
        if (!seen.lit.rgba.empty()) CHECK(is_same(seen.lit, expected.lit));
    }
}
