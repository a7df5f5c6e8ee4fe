// Locked groups, and brushes held to unpainted voxels: no brush changes other voxels, whether it is previewed, painted
// by a script or by hand. The truth is breadth-first search and the definition, voxel by voxel. Random masks and
// volumes state their seed.

#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "engine/live/previewer.h"
#include "engine/session/lasting_settings.h"
#include "tests/reference/components.h"
#include "tests/support/gpu.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr Size3 SIZE(71, 35, 39);  // not multiples of anything that kernels or bricks work in

std::shared_ptr<const MemorySource> noise(uint32_t seed)
{
    std::mt19937 random(seed);
    std::vector<std::byte> bytes(size_t(SIZE.x * SIZE.y * SIZE.z));
    for (std::byte& byte : bytes) byte = std::byte(random() % 200);
    VolumeInfo info{.name = "noise", .format = "raw", .size = SIZE, .type = VoxelType::uint8};
    info.spacing = {1.0, 1.25, 0.75};
    return std::make_shared<MemorySource>(info, std::move(bytes));
}

struct Device {
    Renderer renderer{{.device = {.validation = true}, .budget = {}, .threads = 2}};
    ~Device()
    {
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
};

template <class Visit>
void for_each_voxel(const Visit& visit)
{
    for (int64_t z = 0; z < SIZE.z; ++z)
        for (int64_t y = 0; y < SIZE.y; ++y)
            for (int64_t x = 0; x < SIZE.x; ++x) visit(Size3(x, y, z));
}

std::vector<uint8_t> groups_of(const Annotator& annotator)
{
    std::vector<uint8_t> groups;
    for_each_voxel([&](const Size3& voxel) { groups.push_back(annotator.document().mask.at(voxel)); });
    return groups;
}

glm::dvec3 random_position(std::mt19937& random)
{
    const auto below = [&](int64_t end) { return std::uniform_real_distribution<double>(-1.0, double(end))(random); };
    return {below(SIZE.x), below(SIZE.y), below(SIZE.z)};
}

/// Balls of groups 1 ... 4, and the same ones whenever the seed is the same.
void paint_at_random(Annotator& annotator, uint32_t seed)
{
    std::mt19937 random(seed);
    for (int i = 0; i < 14; ++i)
        annotator.paint({.brush = Brush::fill,
                         .group = uint8_t(1 + i % 4),
                         .threshold = 70.0,
                         .radius_voxels = 6.0 + double(random() % 8),
                         .path = {random_position(random)}});
}

VoxelSelection reference_selection(const VolumeSource& source, std::span<const uint8_t> densities, const PaintOp& op)
{
    const auto open = [&](const Size3& voxel) {
        return double(densities[size_t(voxel.x + SIZE.x * (voxel.y + SIZE.y * voxel.z))]) >= op.threshold;
    };
    VoxelSelection selection(SIZE);
    for (const glm::dvec3& position : stroke_positions(op.path)) {
        const BrushRegion region = make_region(op.region, position, op.radius_voxels, source.info().spacing, SIZE);
        if (region.rows.empty()) continue;
        const std::vector<uint32_t> words =
            op.brush == Brush::fill ? reference::fill_words(region, open)
            : op.brush == Brush::flood
                ? reference::flood_words(region, open, Size3(glm::floor(position)), op.connectivity)
                : reference::speckle_words(region, open, op.connectivity);
        selection.add(region, words);
    }
    return selection;
}

struct Expected {
    StrokeResult result;
    std::vector<uint8_t> groups;
};
Expected expected_of(const PaintOp& op, const std::vector<uint8_t>& before, const VoxelSelection& selection)
{
    Expected expected{.result = {.stroke = op}, .groups = before};
    expected.result.stroke.path.clear();
    size_t at = 0;
    for_each_voxel([&](const Size3& voxel) {
        const uint8_t group = before[at];
        uint8_t& after = expected.groups[at++];
        if (!selection.contains(voxel) || group == op.group) return;
        if (group != 0 && op.locked[group]) {
            ++expected.result.kept_locked[group];
        } else if (op.group != 0 && op.locked[op.group]) {
            ++expected.result.kept_locked_out;
        } else if (op.only_unpainted && group != 0) {
            ++expected.result.kept_painted;
        } else {
            after = op.group;
            ++expected.result.regrouped;
            if (group != 0) ++expected.result.taken_from[group];
        }
    });
    return expected;
}

/// Voxels where a preview and two masks disagree.
int64_t differences(const PaintPreview& preview, const std::vector<uint8_t>& before, const std::vector<uint8_t>& after)
{
    int64_t wrong = 0;
    size_t at = 0;
    for_each_voxel([&](const Size3& voxel) {
        wrong += (before[at] != after[at]) != preview.contains(voxel);
        ++at;
    });
    return wrong;
}

void paint_by_hand(Annotator& annotator, const PaintOp& op)
{
    annotator.begin_stroke(op);
    for (const glm::dvec3& point : op.path) {
        annotator.extend_stroke(point);
        for (int turn = 0; turn < 50; ++turn) annotator.advance();  // answers arrive while the hand moves
    }
    annotator.end_stroke();
    while (annotator.stroke_is_running()) annotator.advance();
}

/// No lock, the lock of each of two groups, of the painted one, of all; held to unpainted voxels or not; erasing. The
/// everyday run takes one `half` of these, 0 or 1, in which any two stand together.
template <class Visit>
void for_each_protection(PaintOp op, size_t half, const Visit& visit)
{
    constexpr unsigned LOCKED[] = {0b0, 0b10, 0b10100, 0b1000, 0b11110};
    for (const size_t erases : {0, 1})
        for (const size_t only_unpainted : {0, 1})
            for (size_t locks = 0; locks < std::size(LOCKED); ++locks) {
                if (!is_slow() && (erases + only_unpainted + locks) % 2 != half) continue;
                op.group = uint8_t(erases == 1 ? 0 : 3);
                op.only_unpainted = only_unpainted == 1;
                op.locked = GroupSet(LOCKED[locks]);
                CAPTURE(int(op.group));
                CAPTURE(op.only_unpainted);
                CAPTURE(LOCKED[locks]);
                visit(op);
            }
}

}  // namespace

TEST_CASE("every brush leaves alone what is locked or held, previewed, by script and by hand, and counts it exactly")
{
    Device device;
    int64_t changed = 0, kept_locked = 0, kept_painted = 0;
    for (const uint32_t seed : {61u, 62u}) {
        const auto source = noise(seed);
        device.renderer.load(source, {.minimum = 0.0, .maximum = 255.0},
                             {.sampling = Sampling::exact, .paging = seed == 61 ? Paging::never : Paging::always});
        std::vector<uint8_t> densities(size_t(SIZE.x * SIZE.y * SIZE.z));
        std::mt19937 again(seed);
        for (uint8_t& density : densities) density = uint8_t(again() % 200);
        Annotator script(device.renderer);
        paint_at_random(script, seed);
        const std::vector<uint8_t> before = groups_of(script);
        const size_t steps = script.history().undoable();
        std::mt19937 random(seed);
        for (const Brush brush : {Brush::fill, Brush::flood, Brush::speckle})
            for (const RegionShape region : {RegionShape::ball, RegionShape::box}) {
                // The everyday half: each brush has one region with resident bricks, and the other with paged ones.
                const size_t shape = region == RegionShape::ball ? 0 : 1;
                if (!is_slow() && (size_t(brush) + shape + seed) % 2 == 0) continue;
                CAPTURE(int(brush));
                CAPTURE(int(region));
                PaintOp plain{.brush = brush,
                              .region = region,
                              .threshold = brush == Brush::speckle ? 150.0 : 60.0,
                              .radius_voxels = 5.0 + double(random() % 5),
                              .connectivity = random() % 2 == 0 ? 6 : 26,
                              .path = {random_position(random), random_position(random)}};
                // Every day half of the stroke, which meets all groups as well.
                if (!is_slow()) plain.path[1] = glm::mix(plain.path[0], plain.path[1], 0.5);
                const VoxelSelection selection = reference_selection(*source, densities, plain);
                for_each_protection(plain, shape, [&](const PaintOp& op) {
                    const Expected expected = expected_of(op, before, selection);
                    const PaintPreview preview = script.preview(op);
                    CHECK(differences(preview, before, expected.groups) == 0);
                    CHECK(preview.voxels == expected.result.regrouped);
                    CHECK(script.select(op).bricks() == selection.bricks());  // locks are no matter of selecting

                    CHECK(script.paint(op) == expected.result.voxels());
                    CHECK((script.last_stroke() == expected.result));
                    CHECK((groups_of(script) == expected.groups));
                    CHECK(script.history().undoable() == steps + (expected.result.regrouped > 0));
                    if (expected.result.regrouped > 0) {  // back, though the groups are locked still
                        script.undo();
                        CHECK((groups_of(script) == before));
                        script.redo();
                        CHECK((groups_of(script) == expected.groups));
                        script.undo();
                    }
                    changed += expected.result.regrouped;
                    kept_locked += expected.result.kept_by_locks();
                    kept_painted += expected.result.kept_painted;
                });
                for_each_protection(plain, 1 - shape, [&](const PaintOp& op) {
                    const Expected expected = expected_of(op, before, selection);
                    paint_by_hand(script, op);
                    CHECK((script.last_stroke() == expected.result));
                    CHECK((groups_of(script) == expected.groups));
                    if (expected.result.regrouped > 0) script.undo();
                });
                CHECK((groups_of(script) == before));
            }
    }
    CHECK(changed > 10'000);
    CHECK(kept_locked > 10'000);
    CHECK(kept_painted > 10'000);
}

TEST_CASE("locks and paint have no say about offsets")
{
    Device device;
    device.renderer.load(noise(63), {.minimum = 0.0, .maximum = 255.0}, {.sampling = Sampling::exact});
    Annotator annotator(device.renderer);
    paint_at_random(annotator, 63);
    PaintOp op{.brush = Brush::fill,
               .group = 3,
               .threshold = 60.0,
               .radius_voxels = 9.0,
               .path = {{30, 17, 20}, {41, 17, 20}},
               .density = DensityBrush{25.0, Falloff::distance},
               .paints_group = false};
    const int64_t raised = annotator.paint(op);
    REQUIRE(raised > 1000);
    annotator.undo();
    const std::vector<uint8_t> before = groups_of(annotator);
    op.paints_group = true;
    op.locked = GroupSet(0b11110);
    op.only_unpainted = true;
    const PaintPreview preview = annotator.preview(op);
    CHECK(preview.voxels == raised);
    CHECK(annotator.paint(op) == raised);
    CHECK(annotator.last_stroke().raised == raised);
    CHECK(annotator.last_stroke().regrouped == 0);
    CHECK(annotator.last_stroke().kept_by_locks() > 0);
    CHECK(annotator.document().density.voxels() == raised);
    CHECK((groups_of(annotator) == before));
    annotator.undo();
    CHECK(annotator.document().density.voxels() == 0);
}

TEST_CASE("a preview that nobody waits for follows the locks of the session")
{
    Device device;
    device.renderer.load(noise(64), {.minimum = 0.0, .maximum = 255.0}, {.sampling = Sampling::exact});
    Annotator annotator(device.renderer);
    paint_at_random(annotator, 64);
    Session session;
    session.groups[1].locked = true;
    session.groups[2].parent = 1;
    session.probe.voxel = {36.0, 17.0, 20.0};
    session.probe.preview = true;
    session.probe.brush = {.brush = Brush::fill, .group = 3, .threshold = 40.0, .radius_voxels = 14.0};
    Previewer previewer(annotator);
    const auto previewed = [&] {
        const PaintOp dab = in_session(stroke_of(session.probe.brush, 0.0, {session.probe.voxel.value()}), session);
        previewer.want(dab);
        for (int turn = 0; turn < 10'000 && !previewer.is_current(); ++turn) {
            previewer.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        REQUIRE(previewer.is_current());
        const std::vector<uint8_t> before = groups_of(annotator);
        const int64_t voxels = annotator.paint(dab);
        CHECK(differences(*previewer.shown(), before, groups_of(annotator)) == 0);
        CHECK(previewer.shown()->voxels == voxels);
        const auto in_picture = shown_probe(session, device.renderer, annotator);
        CHECK(in_picture.value().preview->voxels == 0);  // all that it may have it has
        if (voxels > 0) annotator.undo();
        CHECK(shown_probe(session, device.renderer, annotator).value().preview->words == previewer.shown()->words);
        return voxels;
    };
    const int64_t locked = previewed();
    session.groups[1].locked = false;
    const int64_t open = previewed();
    session.probe.brush.only_unpainted = true;
    const int64_t unpainted = previewed();
    session.probe.brush.only_unpainted = false;
    session.groups[3].locked = true;
    CHECK(previewed() == 0);
    CHECK(0 < unpainted);
    CHECK(unpainted < locked);
    CHECK(locked < open);
}

TEST_CASE("locking between strokes, 60 random steps: undo to the start and redo to the end, bit for bit")
{
    Device device;
    device.renderer.load(noise(65), {.minimum = 0.0, .maximum = 255.0}, {.sampling = Sampling::exact});
    Annotator annotator(device.renderer);
    Session session;
    annotator.change_settings("begin", lasting_settings(session));
    std::mt19937 random(65);
    struct State {
        std::vector<uint8_t> groups;
        SettingValues settings;
        bool operator==(const State&) const = default;
    };
    const auto state = [&] { return State{groups_of(annotator), annotator.work().settings()}; };
    std::vector<State> states{state()};
    int64_t kept = 0;
    for (int step = 0; step < 60; ++step) {
        if (random() % 3 == 0) {
            GroupSettings& group = session.groups[uint8_t(1 + random() % 4)];
            group.locked = !group.locked;
            annotator.change_settings("lock", lasting_settings(session));
        } else {
            PaintOp op{.brush = random() % 2 == 0 ? Brush::fill : Brush::flood,
                       .group = uint8_t(random() % 5),
                       .threshold = 50.0,
                       .radius_voxels = 8.0,
                       .path = {random_position(random), random_position(random)},
                       .only_unpainted = random() % 4 == 0};
            op = in_session(op, session);
            const std::array<int64_t, 256> before = annotator.document().mask.voxels_by_group();
            if (random() % 2 == 0)
                annotator.paint(op);
            else
                paint_by_hand(annotator, op);
            for (size_t group = 1; group < 5; ++group)
                if (op.locked[group]) CHECK(annotator.document().mask.voxels_by_group()[group] == before[group]);
            kept += annotator.last_stroke().kept_by_locks();
            if (annotator.last_stroke().voxels() == 0) continue;
        }
        states.push_back(state());
    }
    CHECK(kept > 1000);
    REQUIRE(annotator.history().undoable() == states.size());  // the first command, too
    for (size_t at = states.size(); --at > 0;) {
        annotator.undo();
        CHECK((state() == states[at - 1]));
    }
    for (size_t at = 1; at < states.size(); ++at) {
        annotator.redo();
        CHECK((state() == states[at]));
    }
}

TEST_CASE("a stroke by hand keeps the locks that it began with")
{
    Device device;
    device.renderer.load(noise(66), {.minimum = 0.0, .maximum = 255.0}, {.sampling = Sampling::exact});
    Annotator annotator(device.renderer);
    paint_at_random(annotator, 66);
    Session session;
    session.groups[2].locked = true;
    const PaintOp op = in_session({.brush = Brush::fill, .group = 1, .threshold = 0.0, .radius_voxels = 12.0}, session);
    const int64_t before = annotator.document().mask.voxels_by_group()[2];
    annotator.begin_stroke(op);
    annotator.extend_stroke({20, 17, 20});
    session.groups[2].locked = false;
    annotator.extend_stroke({50, 17, 20});
    annotator.end_stroke();
    while (annotator.stroke_is_running()) annotator.advance();
    CHECK(annotator.last_stroke().kept_locked.at(2) > 0);
    CHECK(annotator.document().mask.voxels_by_group()[2] == before);
}
