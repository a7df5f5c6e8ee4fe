// Density offsets on the device: a picture after an update equals that of a volume loaded with the offsets, bit for
// bit, resident or paged; brushes see base plus offset.

#include <random>

#include <map>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "engine/volume/levels/pyramid_source.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Source = std::shared_ptr<const VolumeSource>;
constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};

Session session_of(double opacity, double occlusion)
{
    Session session;
    session.transfer_function = TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0},
                                                  {140.0, glm::dvec3(0.9, 0.7, 0.3), opacity},
                                                  {255.0, glm::dvec3(1.0), opacity}});
    session.render.size = {96, 72};
    session.render.sampling = Sampling::exact;
    session.light.occlusion.strength = occlusion;
    session.light.occlusion.radius = 9.0;
    return session;
}

struct Device {
    Renderer renderer{{.device = {.validation = true}, .budget = {}, .threads = 2}};
    ~Device()
    {
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
    void load(const Source& source, Paging paging)
    {
        renderer.load(source, BYTES, {.sampling = Sampling::exact, .paging = paging});
    }
};

std::vector<OffsetSource::Brick> bricks_of(const DensityField& field)
{
    std::vector<OffsetSource::Brick> bricks;
    for (const int64_t brick : field.painted_bricks()) bricks.push_back({field.position_of(brick), field.brick(brick)});
    return bricks;
}

/// The same volume as if its file held the offsets.
Source raised(const Source& source, const DensityField& field)
{
    auto raised = std::make_shared<OffsetSource>(with_levels(source, uint64_t{1} << 30));
    raised->set(bricks_of(field));
    return raised;
}

PaintOp random_dab(std::mt19937& random, const Size3& size)
{
    const auto below = [&](int64_t end) { return double(random() % uint64_t(end)); };
    PaintOp op{.brush = random() % 2 == 0 ? Brush::fill : Brush::flood,
               .region = random() % 2 == 0 ? RegionShape::ball : RegionShape::box,
               .group = uint8_t(1 + random() % 3),
               .threshold = 20.0 + below(40),
               .radius_voxels = 2.0 + below(12),
               .path = {{below(size.x), below(size.y), below(size.z)}}};
    op.path.push_back(op.path[0] + glm::dvec3(below(9), below(9), below(9)));
    op.density = DensityBrush{random() % 4 == 0 ? -30.0 : 20.0 + below(100),
                              random() % 2 == 0 ? Falloff::flat : Falloff::distance};
    op.paints_group = random() % 3 == 0;
    return op;
}

void check_updates(Paging paging, double detail, double occlusion, int trials)
{
    const Source source = open_procedural({.kind = "tubes", .size = {110, 70, 66}, .seed = 3});
    const Camera camera = camera_looking("front", source->info());
    Session session = session_of(0.2, occlusion);
    session.render.detail = detail;
    Device updated, anew;
    updated.load(source, paging);
    Annotator annotator(updated.renderer);
    const ImageF untouched = updated.renderer.render(session, camera).image;
    std::mt19937 random(71);
    size_t different = 0;
    for (int trial = 0; trial < trials; ++trial) {
        CAPTURE(trial);
        if (trial % 4 == 3)
            annotator.undo();
        else
            annotator.paint(random_dab(random, source->info().size));
        const Picture seen = updated.renderer.render(session, camera);
        CHECK(seen.complete);
        const DensityField& field = annotator.document().density;
        anew.load(raised(source, field), paging);
        const std::vector<int64_t> painted = annotator.document().mask.painted_bricks();
        if (!painted.empty()) anew.renderer.scene().update_mask(annotator.document().mask, painted);
        const Picture expected = anew.renderer.render(session, camera);
        check_below("differing bits", double(different_bits(seen.image, expected.image)), 0.0);
        different += different_bits(seen.image, untouched) > 0;
    }
    CHECK(different > 0);
    while (annotator.undo()) {
    }
    CHECK(annotator.document().density.voxels() == 0);
    check_below("differing bits when all is undone",
                double(different_bits(updated.renderer.render(session, camera).image, untouched)), 0.0);
}

}  // namespace

TEST_CASE("a resident volume whose offsets change is drawn as one that has them from the start, bit for bit")
{
    check_updates(Paging::never, 0.0, 0.0, 8);
}

TEST_CASE("so is a paged one, at the finest level and at coarser ones")
{
    check_updates(Paging::always, 0.0, 0.0, 8);
    check_updates(Paging::always, 4.0, 0.0, 8);
}

TEST_CASE("so is the ambient occlusion of both")
{
    check_updates(Paging::never, 0.0, 0.7, 4);
    check_updates(Paging::always, 0.0, 0.7, 4);
}

TEST_CASE("many offsets at once, as a file brings them, are seen in paged bricks")
{
    const Source source = open_procedural({.kind = "tubes", .size = Size3(288), .seed = 3});
    const Camera camera = camera_looking("front", source->info());
    Session session = session_of(0.01, 0.0);
    session.render.detail = 0.0;
    Device updated, anew;
    updated.load(source, Paging::always);
    static_cast<void>(updated.renderer.render(session, camera));
    REQUIRE(updated.renderer.volume().counts()->resident > 200);
    DensityField field(source->info().size, source->info().type);
    std::vector<VoxelBox> boxes;
    for (int64_t brick = 0; brick < 729; ++brick) {
        OffsetBrick offsets;
        offsets.fill(offset_bits(field.type(), double(brick % 90)));
        field.put(brick, offsets);
        boxes.push_back(voxels_of({0, field.position_of(brick)}, field.size()));
    }
    updated.renderer.scene().update_density(field, boxes);
    const Picture seen = updated.renderer.render(session, camera);
    CHECK(seen.complete);
    anew.load(raised(source, field), Paging::always);
    CHECK(different_bits(seen.image, anew.renderer.render(session, camera).image) == 0);
}

TEST_CASE("brushes see base plus offset: what was raised above a threshold is filled, and what was lowered is not")
{
    const Size3 size(40, 40, 40);
    for (const Paging paging : {Paging::never, Paging::always}) {
        const Source source = open_procedural({.kind = "constant", .size = size});
        Device device;
        device.load(source, paging);
        Annotator annotator(device.renderer);
        const double value = measure(*source).minimum;
        PaintOp fill{
            .brush = Brush::fill, .group = 1, .threshold = value + 5.0, .radius_voxels = 6.0, .path = {{30, 30, 30}}};
        CHECK(annotator.select(fill).count() == 0);
        PaintOp raise = fill;
        raise.threshold = value;
        raise.radius_voxels = 3.0;
        raise.density = DensityBrush{10.0, Falloff::flat};
        raise.paints_group = false;
        const int64_t raised_voxels = annotator.paint(raise);
        CHECK(raised_voxels > 50);
        CHECK(annotator.document().mask.painted_bricks().empty());
        CHECK(annotator.select(fill).count() == raised_voxels);
        fill.threshold = value + 10.5;
        CHECK(annotator.select(fill).count() == 0);
        fill.threshold = value + 10.0;
        CHECK(annotator.select(fill).count() == raised_voxels);

        // Group 0 removes the offsets and the paint; one undo restores both.
        PaintOp both = raise;
        both.paints_group = true;
        both.group = 4;
        CHECK(annotator.paint(both) == raised_voxels);  // offsets stay unchanged
        PaintOp reset = both;
        reset.group = 0;
        CHECK(annotator.paint(reset) == 2 * raised_voxels);
        CHECK(annotator.document().density.voxels() == 0);
        CHECK(annotator.document().mask.painted_bricks().empty());
        CHECK(annotator.select(fill).count() == 0);
        REQUIRE(annotator.undo());
        CHECK(annotator.document().density.voxels() == raised_voxels);
        CHECK(annotator.document().mask.voxels_by_group()[4] == raised_voxels);
        CHECK(annotator.select(fill).count() == raised_voxels);
    }
}

TEST_CASE("a stroke by hand paints what a script paints")
{
    const Source source = open_procedural({.kind = "tubes", .size = {110, 70, 66}, .seed = 3});
    Device device;
    device.load(source, Paging::never);
    PaintOp op{.brush = Brush::fill,
               .group = 2,
               .threshold = 40.0,
               .radius_voxels = 7.0,
               .path = {{30, 30, 30}, {60, 35, 33}}};
    op.density = DensityBrush{60.0, Falloff::distance};
    Annotator script(device.renderer);
    const int64_t voxels = script.paint(op);
    REQUIRE(voxels > 0);
    const DensityField expected = script.document().density;
    REQUIRE(script.undo());
    Annotator hand(device.renderer);
    hand.begin_stroke(op);
    for (const glm::dvec3& at : op.path) hand.extend_stroke(at);
    hand.end_stroke();
    while (hand.stroke_is_running()) hand.advance();
    CHECK(hand.last_stroke().voxels() == voxels);
    REQUIRE(hand.document().density.painted_bricks() == expected.painted_bricks());
    for (const int64_t brick : expected.painted_bricks())
        CHECK((*hand.document().density.brick(brick) == *expected.brick(brick)));
    CHECK(hand.history().undoable() == 1);
}

TEST_CASE("offsets cost no byte on the device")
{
    const Source source = open_procedural({.kind = "tubes", .size = {110, 70, 66}, .seed = 3});
    const Camera camera = camera_looking("front", source->info());
    const Session session = session_of(0.2, 0.0);
    Device device;
    device.load(source, Paging::never);
    static_cast<void>(device.renderer.render(session, camera));
    const auto lasting = [&] {  // temporary memory of brushes and uploads is kept for reuse
        std::map<std::string, uint64_t> bytes = device.renderer.memory().bytes_by_name();
        std::erase_if(bytes, [](const auto& entry) {
            return entry.second == 0 || entry.first.starts_with("region ") || entry.first.starts_with("brick ") ||
                   entry.first == "blocks" || entry.first == "staging" || entry.first == "read back";
        });
        return bytes;
    };
    const std::map<std::string, uint64_t> before = lasting();
    Annotator annotator(device.renderer);
    PaintOp op{.brush = Brush::fill, .group = 2, .threshold = 40.0, .radius_voxels = 7.0, .path = {{30, 30, 30}}};
    op.density = DensityBrush{60.0, Falloff::flat};
    op.paints_group = false;
    REQUIRE(annotator.paint(op) > 0);
    static_cast<void>(device.renderer.render(session, camera));
    for (const auto& [name, bytes] : lasting())
        CHECK_MESSAGE((before.contains(name) && before.at(name) == bytes), name, ": ", bytes, " bytes");
}
