// Atlases of several images, on devices of which one holds too few bricks (tests/layers/records.h).

#include <algorithm>
#include <array>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/annotator.h"
#include "shaders/bricks.h"
#include "tests/gpu/devices/on_record.h"
#include "tests/support/slow.h"
#include "tests/support/stored_volume.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};

/// A view of a volume whose rays visit all of its bricks, and a stroke through it.
struct Stacked {
    Session session = plain_session({{0.0, RED, 0.002}, {255.0, BLUE, 0.01}}, {40, 30});
    std::shared_ptr<const VolumeSource> source;
    Camera camera;
    PaintOp op;
    size_t bricks;  ///< number of bricks in the finest level

    Stacked(const Size3& size, std::vector<glm::dvec3> path)
        : source(stored_volume("tubes", size, 5)),
          camera(camera_looking("right", source->info())),
          op{.brush = Brush::fill, .group = 3, .threshold = 60.0, .radius_voxels = 12.0, .path = std::move(path)}
    {
        session.light.shaded = true;
        session.render.detail = 0.0;
        session.render.paging = Paging::always;
        const Size3 counts = (size + int64_t{31}) / int64_t{32};
        bricks = size_t(counts.x * counts.y * counts.z);
    }

    struct Drawn {
        ImageF plain, painted, lit;
        std::array<int64_t, 256> voxels{};
    };
    Drawn drawn(Renderer& renderer, size_t images, bool lights) const
    {
        renderer.load(source, BYTES, session.render);
        Drawn made{.plain = renderer.render(session, camera).image, .painted = {}, .lit = {}};
        const DeviceVolume::Counts counts = renderer.volume().counts().value();
        CHECK(counts.resident > bricks);
        CHECK(counts.evictions == 0);
        FrameGraph graph;
        CHECK(1 + renderer.volume().atlas(graph).more_atlases.size() == images);
        // A brick lies in each of them.
        std::vector<bool> has_bricks(4);
        const uint32_t height = renderer.volume().atlas_slots().z / uint32_t(images);
        for (const DeviceVolume::Place& place : renderer.volume().places())
            has_bricks.at(gpu::unpack_slot(place.slot).z / height) = true;
        CHECK(std::ranges::count(has_bricks, true) == ptrdiff_t(images));
        if (lights) {
            Session lit = session;
            lit.light.occlusion = {.strength = 0.9, .radius = 4.0, .rays = 2};
            // Each brick has some of what shows. Light costs by the voxels that show: every day it is less of all.
            if (!is_slow()) lit.transfer_function = TransferFunction({{100.0, RED, 0.0}, {255.0, BLUE, 0.05}});
            const Picture picture = renderer.render(lit, camera);
            for (const std::string& warning : picture.warnings) MESSAGE(warning);
            if (picture.warnings.empty()) made.lit = picture.image;
        }
        Annotator annotator(renderer);
        annotator.paint(op);
        made.voxels = annotator.document().mask.voxels_by_group();
        made.painted = renderer.render(session, camera).image;
        return made;
    }

    /// Compares a device of the record with one that holds all bricks in one image. `lights`: the record's device has
    /// room for the light; otherwise it must report that.
    void compare(const char* record, Sampling sampling, size_t images, bool lights)
    {
        CAPTURE(std::string(record));
        CAPTURE(int(sampling));
        session.render.sampling = sampling;
        if (!expected_ || expected_of_ != sampling) {
            Renderer plain({.device = {.validation = true}, .threads = 1});
            expected_ = drawn(plain, 1, lights);
            expected_of_ = sampling;
        }
        const Drawn& expected = *expected_;
        CHECK(expected.voxels[3] > 1000);
        CHECK((!lights || !expected.lit.rgba.empty()));
        On device(record);
        const Drawn seen = drawn(*device, images, true);
        // A filter is asked for other places of the texture.
        const auto is_same = [&](const ImageF& a, const ImageF& b) {
            return sampling == Sampling::exact ? different_bits(a, b) == 0
                                               : compare_pixels(to_image8(a), to_image8(b)).max_abs <= 1.0;
        };
        CHECK(is_same(seen.plain, expected.plain));
        CHECK(is_same(seen.painted, expected.painted));
        CHECK(seen.voxels == expected.voxels);
        CHECK(different_bits(seen.painted, seen.plain) > 0);
        CHECK(seen.lit.rgba.empty() == !lights);
        if (!seen.lit.rgba.empty()) CHECK(is_same(seen.lit, expected.lit));
    }

private:
    std::optional<Drawn> expected_{};  ///< on a device that holds all bricks in one image
    Sampling expected_of_ = Sampling::automatic;
};

}  // namespace

TEST_CASE("paged bricks fill more images than one, to the bits of bricks in one")
{
    // 512 bricks, and coarser ones; the images of these devices hold 343 and 320. The light's are too large for the
    // first device.
    Stacked stacked({250, 250, 250}, {{70, 60, 60}, {180, 170, 200}});
    stacked.compare("filters", Sampling::exact, 2, true);
    stacked.compare("minimum", Sampling::exact, 2, false);
    if (is_slow()) stacked.compare("filters", Sampling::hardware, 2, true);
}

TEST_CASE("paged bricks fill as many images as kernels know, to the bits of bricks in one")
{
    // Where samplers read codes, they take two bytes instead of one. Light has one image, half as large as all codes.
    struct Tried {
        int length;
        Sampling sampling;
        size_t images;
    };
    for (const Tried& tried : {Tried{160, Sampling::hardware, 3},
                               {230, Sampling::hardware, 4},
                               {310, Sampling::exact, 3},
                               {480, Sampling::exact, 4}}) {
        CAPTURE(tried.length);
        // Every day a filter reads three images, and exact samples four.
        if (!is_slow() && tried.length != 160 && tried.length != 480) continue;
        Stacked stacked({190, 190, tried.length}, {{30, 40, 20}, {150, 140, tried.length - 20}});
        stacked.compare("pieces", tried.sampling, tried.images, false);
    }
}
