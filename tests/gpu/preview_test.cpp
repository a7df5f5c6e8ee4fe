// The preview of a brush: it equals the set that is painted, whatever the brush, and showing it changes nothing.
// Pictures show exactly that set, compared with boxes intersected in double on the CPU.

#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "engine/live/previewer.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr Size3 SIZE(41, 33, 36);

/// Noise in bytes, slightly smoothed to give connected pieces of all sizes.
std::shared_ptr<const VolumeSource> noise(uint32_t seed)
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
    void load(const std::shared_ptr<const VolumeSource>& source, Paging paging = Paging::never)
    {
        renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, {.sampling = Sampling::exact, .paging = paging});
    }
};

template <class Visit>
void for_each_voxel(const Visit& visit)
{
    for (int64_t z = 0; z < SIZE.z; ++z)
        for (int64_t y = 0; y < SIZE.y; ++y)
            for (int64_t x = 0; x < SIZE.x; ++x) visit(Size3(x, y, z));
}

struct Snapshot {
    std::vector<uint8_t> groups;
    std::vector<double> offsets;
    size_t undoable = 0, redoable = 0;
    bool operator==(const Snapshot&) const = default;
};

Snapshot snapshot(const Annotator& annotator)
{
    Snapshot taken{.undoable = annotator.history().undoable(), .redoable = annotator.history().redoable()};
    for_each_voxel([&](const Size3& voxel) {
        taken.groups.push_back(annotator.document().mask.at(voxel));
        taken.offsets.push_back(annotator.document().density.at(voxel));
    });
    return taken;
}

/// Voxels where a painted document and a preview disagree, and the number of changed voxels.
struct Compared {
    int64_t wrong = 0, changed = 0;
};
Compared compared(const PaintPreview& preview, const Snapshot& before, const Snapshot& after)
{
    Compared sum;
    size_t i = 0;
    for_each_voxel([&](const Size3& voxel) {
        const bool has_changed = before.groups[i] != after.groups[i] || before.offsets[i] != after.offsets[i];
        sum.wrong += has_changed != preview.contains(voxel);
        sum.changed += has_changed;
        ++i;
    });
    return sum;
}

/// Paints several groups, and offsets, where brushes will be.
void prepare(Annotator& annotator)
{
    PaintOp op{.brush = Brush::fill, .region = RegionShape::ball, .group = 2, .threshold = 60.0, .radius_voxels = 7.0};
    op.path = {{14.5, 12.5, 14.5}};
    annotator.paint(op);
    op.group = 1;
    op.path = {{22.5, 19.5, 18.5}};
    op.density = DensityBrush{35.0, Falloff::distance};
    annotator.paint(op);
}

const std::optional<DensityBrush> DENSITIES[] = {std::nullopt, DensityBrush{30.0, Falloff::flat},
                                                 DensityBrush{80.0, Falloff::distance},
                                                 DensityBrush{-25.0, Falloff::flat}};

template <class Check>
void for_each_brush(std::mt19937& random, const Check& check)
{
    const auto below = [&](double end) { return std::uniform_real_distribution<double>(-1.0, end)(random); };
    for (const Brush brush : {Brush::fill, Brush::flood, Brush::speckle})
        for (const RegionShape region : {RegionShape::ball, RegionShape::box})
            for (const int connectivity : {6, 26})
                for (const int group : {0, 1, 2})
                    for (const std::optional<DensityBrush>& density : DENSITIES)
                        for (const bool paints_group : {true, false}) {
                            if (!paints_group && !density) continue;
                            check(PaintOp{.brush = brush,
                                          .region = region,
                                          .group = uint8_t(group),
                                          .threshold = brush == Brush::flood ? 90.0 : 130.0,
                                          .radius_voxels = 2.0 + double(random() % 9),
                                          .connectivity = connectivity,
                                          .path = {{below(30.0), below(26.0), below(30.0)}},
                                          .density = density,
                                          .paints_group = paints_group});
                        }
}

}  // namespace

TEST_CASE("what is previewed is what is painted, with every brush, and nothing changes by looking")
{
    Device device;
    int64_t changed = 0, previewed_nothing = 0, brushes = 0;
    for (const uint32_t seed : {1u, 2u}) {
        device.load(noise(seed), seed == 1 ? Paging::never : Paging::always);
        Annotator annotator(device.renderer);
        prepare(annotator);
        Snapshot before = snapshot(annotator);
        std::mt19937 random(seed);
        for_each_brush(random, [&](const PaintOp& op) {
            CAPTURE(int(op.brush));
            CAPTURE(int(op.region));
            CAPTURE(op.connectivity);
            CAPTURE(int(op.group));
            CAPTURE(op.density.has_value());
            CAPTURE(op.paints_group);
            const PaintPreview preview = annotator.preview(op);
            CHECK(snapshot(annotator) == before);
            annotator.paint(op);
            const Snapshot after = snapshot(annotator);
            const Compared found = compared(preview, before, after);
            CHECK(found.wrong == 0);
            CHECK(preview.voxels == found.changed);
            changed += found.changed;
            previewed_nothing += preview.voxels == 0;
            ++brushes;
            before = after;
        });
    }
    CHECK(brushes == 2 * 3 * 2 * 2 * 3 * 7);
    CHECK(changed > 20'000);
    CHECK(previewed_nothing < brushes / 2);
}

TEST_CASE(
    "a preview that nobody waits for comes to the same, follows what is painted, and costs nothing where none is "
    "wanted")
{
    Device device;
    device.load(noise(5));
    Annotator annotator(device.renderer);
    prepare(annotator);
    Previewer previewer(annotator);
    const auto settle = [&] {
        for (int turn = 0; turn < 10'000 && !previewer.is_current(); ++turn) {
            previewer.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        REQUIRE(previewer.is_current());
    };
    PaintOp op{
        .brush = Brush::fill, .group = 3, .threshold = 100.0, .radius_voxels = 6.0, .path = {{20.5, 16.5, 17.5}}};
    previewer.want(op);
    CHECK_FALSE(previewer.is_current());
    settle();
    REQUIRE(previewer.shown());
    CHECK(previewer.shown()->words == annotator.preview(op).words);
    CHECK(previewer.shown()->voxels > 100);

    const std::shared_ptr<const PaintPreview> before = previewer.shown();
    previewer.want(op);
    for (int turn = 0; turn < 5; ++turn) previewer.advance();
    CHECK(previewer.shown() == before);  // no query was submitted

    annotator.paint(op);
    CHECK_FALSE(previewer.is_current());
    settle();
    CHECK(previewer.shown()->voxels == 0);  // all of them are in the group now
    annotator.undo();
    settle();
    CHECK(previewer.shown()->words == before->words);

    op.path = {{-40.0, 5.0, 5.0}};
    previewer.want(op);
    settle();
    CHECK(previewer.shown()->voxels == 0);

    previewer.want(std::nullopt);
    previewer.advance();
    CHECK(previewer.shown() == nullptr);
    CHECK(previewer.is_current());
}

namespace {

/// Where a line first meets a box; null if it misses.
std::optional<double> met(const glm::dvec3& from, const glm::dvec3& way, const glm::dvec3& lower,
                          const glm::dvec3& upper)
{
    double begin = 0.0, end = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (lower[axis] - from[axis]) / way[axis], b = (upper[axis] - from[axis]) / way[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(begin < end)) return std::nullopt;
    return begin;
}

/// The voxel of a preview that a pixel shows, by trying all of them.
std::optional<Size3> first_voxel(const PaintPreview& preview, const RayPlanes& planes, const glm::dvec2& pixel)
{
    const glm::dvec3 near = planes.near_corner + pixel.x * planes.near_dx + pixel.y * planes.near_dy;
    const glm::dvec3 far = planes.far_corner + pixel.x * planes.far_dx + pixel.y * planes.far_dy;
    std::optional<Size3> first;
    double nearest = 2.0;
    for (int64_t z = preview.box.lower.z; z < preview.box.upper.z; ++z)
        for (int64_t y = preview.box.lower.y; y < preview.box.upper.y; ++y)
            for (int64_t x = preview.box.lower.x; x < preview.box.upper.x; ++x) {
                if (!preview.contains({x, y, z})) continue;
                const glm::dvec3 corner(x, y, z);
                if (const auto at = met(near, far - near, corner, corner + 1.0); at && *at < nearest) {
                    nearest = *at;
                    first = Size3(x, y, z);
                }
            }
    return first;
}

/// Hides the volume, and shows colours unlit.
Session bare_session(const glm::uvec2& size)
{
    Session session = plain_session({{254.0, WHITE, 0.0}, {255.0, WHITE, 0.0}}, size);
    session.light = {.ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    return session;
}

glm::vec3 pixel_of(const ImageF& image, int x, int y)
{
    const float* const at = &image.rgba[4 * (size_t(x) + size_t(image.width) * size_t(y))];
    return {at[0], at[1], at[2]};
}

}  // namespace

TEST_CASE("pictures show the voxels of the preview, each where its cube is")
{
    Device device;
    device.load(noise(7));
    Annotator annotator(device.renderer);
    prepare(annotator);
    const VolumeInfo& info = device.renderer.volume().info();
    Session session = bare_session({90, 70});
    for (const uint8_t group : {uint8_t(1), uint8_t(2)})
        session.groups[group].visible = false;  // paint would hide some
    int hits = 0, wrong = 0, pixels = 0;
    for (const char* side : {"front", "top", "right"}) {
        Camera camera = camera_looking(side, info);
        camera.eye += glm::dvec3(7.0, 11.0, 5.0);
        // Erasing draws stripes, which distinguish voxels.
        const PaintOp op{.brush = Brush::fill,
                         .region = RegionShape::ball,
                         .group = 0,
                         .threshold = 60.0,
                         .radius_voxels = 8.0,
                         .path = {{18.5, 15.5, 16.5}}};
        ProbeLook look{.center = op.path[0] * info.spacing, .radius = 8.0, .ball_share = 0.0};
        look.preview = std::make_shared<PaintPreview>(annotator.preview(op));
        REQUIRE(look.preview->voxels > 300);
        const ImageF image = device.renderer.render(session, camera, {.probe = look}).image;
        const RayPlanes planes = ray_planes(camera, session.render.size, info);
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 90; ++x, ++pixels) {
                const glm::vec3 seen = pixel_of(image, x, y);
                const auto voxel = first_voxel(*look.preview, planes, {x + 0.5, y + 0.5});
                hits += voxel.has_value();
                if (!voxel) {
                    wrong += seen != glm::vec3(0.0f);
                    continue;
                }
                const bool is_dark = ((voxel->x + voxel->y + voxel->z) / 2 & 1) != 0;
                wrong += std::abs(seen.r - (is_dark ? 0.12f : 1.0f)) > 1e-4f || seen.b > 1e-4f;
            }
    }
    CHECK(hits > 400);
    CHECK(wrong <= pixels / 1000);  // rays along an edge may go either way
    MESSAGE(wrong, " of ", pixels, " pixels on edges");
}

TEST_CASE("slices show the preview's voxels, and what lies before it hides all but a share of it")
{
    Device device;
    device.load(noise(9));
    Annotator annotator(device.renderer);
    const VolumeInfo& info = device.renderer.volume().info();
    const PaintOp op{
        .brush = Brush::fill, .group = 3, .threshold = 90.0, .radius_voxels = 9.0, .path = {{20.3, 16.2, 18.4}}};
    ProbeLook look{.center = op.path[0] * info.spacing, .radius = 9.0, .color = {0.0, 1.0, 0.0}, .ball_share = 0.0};
    Session session = bare_session({160, 120});
    session.probe.voxel = op.path[0];
    session.view.arrangement = Arrangement::slices;
    session.view.slices.black = 254.0;  // all of the volume is black
    session.view.slices.white = 255.0;
    const Camera camera = camera_looking("front", info);
    const ImageF without = device.renderer.render(session, camera, {.probe = look}).image;
    look.preview = std::make_shared<PaintPreview>(annotator.preview(op));
    const ImageF with = device.renderer.render(session, camera, {.probe = look}).image;
    int spilled = 0, missing = 0, inside = 0;
    for (const Pane& pane : panes_of(session.view, camera, session.render.size, info, op.path[0])) {
        if (pane.kind != Pane::Kind::slice) continue;
        const glm::uvec2 size = pane.box.end - pane.box.begin;
        const RayPlanes planes = ray_planes(pane.shot.camera, size, info);
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                const glm::dvec2 at(x + 0.5, y + 0.5);
                const glm::dvec3 near = planes.near_corner + at.x * planes.near_dx + at.y * planes.near_dy;
                const glm::dvec3 far = planes.far_corner + at.x * planes.far_dx + at.y * planes.far_dy;
                const bool is_previewed = look.preview->contains(Size3(glm::floor(0.5 * (near + far))));
                const int column = int(pane.box.begin.x + x), row = int(pane.box.begin.y + y);
                const bool is_shown = pixel_of(with, column, row) != pixel_of(without, column, row);
                inside += is_previewed;
                spilled += is_shown && !is_previewed;
                missing += is_previewed && !is_shown;
            }
    }
    CHECK(inside > 200);
    CHECK(spilled <= inside / 100);
    CHECK(missing <= inside / 8);  // the lines of the cross cover it

    // A wall in front of it.
    session.view.arrangement = Arrangement::single;
    session.cut = {};
    session.transfer_function = TransferFunction({{0.0, glm::dvec3(0.0), 1.0}, {255.0, glm::dvec3(0.0), 1.0}});
    const glm::vec3 hidden = pixel_of(device.renderer.render(session, camera, {.probe = look}).image, 80, 60);
    CHECK(hidden.g == doctest::Approx(0.55).epsilon(0.02));  // of a green that is a fifth white
    CHECK(hidden.r == doctest::Approx(0.55 * 0.2).epsilon(0.02));
    // A ball of the session, which is opaque and nearer, hides all of it.
    device.renderer.scene().set_surfaces({{.from = look.center,
                                           .to = look.center,
                                           .radius_from = 14.0,
                                           .radius_to = 14.0,
                                           .color = glm::dvec3(0.0, 0.0, 1.0)}});
    session.transfer_function = TransferFunction({{254.0, glm::dvec3(0.0), 0.0}, {255.0, glm::dvec3(0.0), 0.0}});
    const glm::vec3 behind = pixel_of(device.renderer.render(session, camera, {.probe = look}).image, 80, 60);
    CHECK(behind.g == 0.0f);
    CHECK(behind.b > 0.9f);
}
