// Brushes on the device against breadth-first search, and commands through the annotator against pictures and masks.
// Random volumes state their seed.

#include "engine/passes/paint.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/reference/components.h"
#include "tests/support/bounds.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

Renderer::Options with_validation()
{
    return {.device = {.device = "", .validation = true}};
}

/// A volume in memory as doubles, and the type it is loaded as.
struct Voxels {
    Size3 size{1};
    VoxelType type = VoxelType::uint8;
    glm::dvec3 spacing{1.0};
    std::vector<double> values{};
    double at(const Size3& voxel) const { return values[size_t(voxel.x + size.x * (voxel.y + size.y * voxel.z))]; }
};

template <class Value>
Voxels voxels_of(const Size3& size, VoxelType type, const Value& value)
{
    Voxels voxels{.size = size, .type = type};
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) voxels.values.push_back(value(Size3(x, y, z)));
    return voxels;
}

/// 200 where `open`, 50 elsewhere.
template <class Open>
Voxels pattern(const Size3& size, const Open& open)
{
    return voxels_of(size, VoxelType::uint8, [&](const Size3& v) { return open(v) ? 200.0 : 50.0; });
}

/// 0 ... 999, so that a threshold of 1000 (1 - density) opens that fraction of the voxels.
Voxels noise(const Size3& size, uint32_t seed)
{
    std::mt19937 random(seed);
    return voxels_of(size, VoxelType::uint16, [&](const Size3&) { return double(random() % 1000); });
}

template <class T>
MemorySource source_as(const Voxels& voxels)
{
    VolumeInfo info{.name = "memory", .format = "raw", .size = voxels.size, .type = voxels.type};
    info.spacing = voxels.spacing;
    std::vector<std::byte> bytes(voxels.values.size() * sizeof(T));
    for (size_t i = 0; i < voxels.values.size(); ++i) {
        const T value = static_cast<T>(voxels.values[i]);
        std::memcpy(bytes.data() + i * sizeof(T), &value, sizeof(T));
    }
    return {info, std::move(bytes)};
}

MemorySource source_of(const Voxels& voxels)
{
    switch (voxels.type) {
        case VoxelType::uint8: return source_as<uint8_t>(voxels);
        case VoxelType::int8: return source_as<int8_t>(voxels);
        case VoxelType::uint16: return source_as<uint16_t>(voxels);
        case VoxelType::int16: return source_as<int16_t>(voxels);
        case VoxelType::uint32: return source_as<uint32_t>(voxels);
        case VoxelType::int32: return source_as<int32_t>(voxels);
        case VoxelType::float32: return source_as<float>(voxels);
        case VoxelType::float64: return source_as<double>(voxels);
    }
    return source_as<uint8_t>(voxels);
}

void load(Renderer& renderer, const Voxels& voxels, Sampling sampling = Sampling::automatic)
{
    const MemorySource source = source_of(voxels);
    renderer.load(std::make_shared<MemorySource>(source), measure(source), {.sampling = sampling});
}

bool filters_in_hardware(Renderer& renderer)
{
    return renderer.device().traits().linear_r16;
}

std::vector<uint32_t> reference_words(const Voxels& voxels, const PaintOp& op, const BrushRegion& region,
                                      const glm::dvec3& position)
{
    const auto open = [&](const Size3& voxel) { return voxels.at(voxel) >= op.threshold; };
    switch (op.brush) {
        case Brush::fill: return reference::fill_words(region, open);
        case Brush::flood: return reference::flood_words(region, open, Size3(glm::floor(position)), op.connectivity);
        case Brush::speckle: return reference::speckle_words(region, open, op.connectivity);
    }
    return {};
}

VoxelSelection reference_selection(const Voxels& voxels, const PaintOp& op)
{
    VoxelSelection selection(voxels.size);
    for (const glm::dvec3& position : stroke_positions(op.path)) {
        const BrushRegion region = make_region(op.region, position, op.radius_voxels, voxels.spacing, voxels.size);
        if (!region.rows.empty()) selection.add(region, reference_words(voxels, op, region, position));
    }
    return selection;
}

/// Number of voxels that only one of them contains.
int64_t differences(const VoxelSelection& a, const VoxelSelection& b)
{
    int64_t sum = 0;
    const auto count = [&](const VoxelSelection& from, const VoxelSelection& other, bool common) {
        for (const auto& [index, bits] : from.bricks()) {
            const auto found = other.bricks().find(index);
            if (found != other.bricks().end() && !common) continue;
            for (size_t i = 0; i < bits.size(); ++i)
                sum += std::popcount(bits[i] ^ (found == other.bricks().end() ? 0u : found->second[i]));
        }
    };
    count(a, b, true);
    count(b, a, false);
    return sum;
}

/// Compares the device's answer with the reference; returns how many voxels it contains.
int64_t check_against_reference(Annotator& annotator, const Voxels& voxels, const PaintOp& op)
{
    const VoxelSelection selection = annotator.select(op);
    CAPTURE(int(op.brush));
    CAPTURE(int(op.region));
    CAPTURE(op.connectivity);
    CAPTURE(op.threshold);
    CAPTURE(op.radius_voxels);
    CAPTURE(op.path[0].x);
    CAPTURE(op.path[0].y);
    CAPTURE(op.path[0].z);
    check_below("differing voxels", double(differences(selection, reference_selection(voxels, op))), 0.0);
    return selection.count();
}

/// Every brush, region and connectivity.
void check_all_brushes(Annotator& annotator, const Voxels& voxels, PaintOp op)
{
    for (const RegionShape region : {RegionShape::ball, RegionShape::box})
        for (const Brush brush : {Brush::fill, Brush::flood, Brush::speckle})
            for (const int connectivity : {6, 26}) {
                if (brush == Brush::fill && connectivity == 26) continue;
                op.brush = brush;
                op.region = region;
                op.connectivity = connectivity;
                check_against_reference(annotator, voxels, op);
            }
}

PaintOp flood_at(const glm::dvec3& position, double radius, double threshold = 100.0)
{
    return {.brush = Brush::flood,
            .region = RegionShape::box,
            .group = 1,
            .threshold = threshold,
            .radius_voxels = radius,
            .path = {position}};
}

PaintOp fill_at(const glm::dvec3& position, double radius, uint8_t group)
{
    PaintOp op = flood_at(position, radius, -1e9);
    op.brush = Brush::fill;
    op.group = group;
    return op;
}

double uniform(std::mt19937& random, double lower, double upper)
{
    return lower + (upper - lower) * (double(random()) / 4294967296.0);
}

/// One path, one voxel wide, through a whole cube of that side.
bool is_serpentine(const Size3& v, int64_t side)
{
    const int64_t last_row = (side - 1) / 2 * 2;
    if (v.y > last_row) return false;
    const bool ends_far = last_row / 2 % 2 == 0;  // the slice's last row runs from x = 0 to the far side
    if (v.z % 2 == 1) {
        if (v.z / 2 % 2 == 1) return v.x == 0 && v.y == 0;
        return v.x == (ends_far ? side - 1 : 0) && v.y == last_row;
    }
    if (v.y % 2 == 1) return v.x == (v.y / 2 % 2 == 0 ? side - 1 : 0);
    return true;
}

/// Two arms that never touch, wound around each other along z.
int spiral_arm(const Size3& v, int64_t side)
{
    constexpr double PITCH = 10.0;
    const double x = double(v.x) + 0.5 - double(side) / 2, y = double(v.y) + 0.5 - double(side) / 2;
    const double turns = (std::atan2(y, x) / (2.0 * std::numbers::pi) + 0.5);
    const double phase = std::hypot(x, y) / PITCH - turns;
    const double share = phase - std::floor(phase);
    return share < 0.25 ? 1 : share >= 0.5 && share < 0.75 ? 2 : 0;
}

/// In a cube of that side: one bar to each face, and next to each a bar that stops one voxel short of it.
bool is_bar_to_a_face(const Size3& v, int64_t side)
{
    for (int axis = 0; axis < 3; ++axis)
        for (const bool far : {false, true}) {
            const int64_t along = far ? side - 1 - v[axis] : v[axis];
            const int64_t a = v[(axis + 1) % 3] - side / 2, b = v[(axis + 2) % 3] - side / 2;
            if (along < 8 && a == 2 && b == 2) return true;
            if (along > 0 && along < 8 && a == -2 && b == -2) return true;
        }
    return false;
}

std::vector<float> picture(Renderer& renderer, const Session& session)
{
    return renderer.render(session, camera_looking("front", renderer.volume().info())).image.rgba;
}

/// Unshaded, densities from 100 to 200 in opaque red on white.
Session plain_session()
{
    Session session;
    session.transfer_function =
        TransferFunction({{100.0, glm::dvec3(1.0, 0.0, 0.0), 1.0}, {200.0, glm::dvec3(1.0, 0.0, 0.0), 1.0}});
    session.light.shaded = false;
    session.render.size = {48, 48};
    return session;
}

glm::vec4 pixel(const std::vector<float>& picture, size_t x, size_t y)
{
    const float* p = &picture[4 * (x + 48 * y)];
    return {p[0], p[1], p[2], p[3]};
}

size_t differing(const std::vector<float>& a, const std::vector<float>& b)
{
    REQUIRE(a.size() == b.size());
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return count;
}

uint64_t mask_bytes(Renderer& renderer)
{
    uint64_t sum = 0;
    for (const auto& [name, bytes] : renderer.memory().bytes_by_name())
        if (name == "mask" || name == "mask table") sum += bytes;
    return sum;
}

std::vector<uint8_t> groups_of(const Mask& mask)
{
    std::vector<uint8_t> groups;
    for (const int64_t index : mask.painted_bricks()) {
        groups.push_back(uint8_t(index));
        groups.insert(groups.end(), mask.brick(index)->begin(), mask.brick(index)->end());
    }
    return groups;
}

std::string messages_of(Renderer& renderer)
{
    std::string all;
    for (const std::string& message : renderer.device().take_validation_messages()) all += message + "\n";
    return all;
}

}  // namespace

TEST_CASE("brushes agree with breadth-first search around the percolation thresholds")
{
    Renderer renderer(with_validation());
    std::mt19937 random(51);  // seed 51; volumes: 510 ... 515
    for (uint32_t trial = 0; trial < 6; ++trial) {
        const Size3 size = trial < 4 ? Size3(48) : Size3(110, 33, 40);
        const Voxels voxels = noise(size, 510 + trial);
        const bool filtered = trial % 2 == 1 && filters_in_hardware(renderer);
        load(renderer, voxels, filtered ? Sampling::hardware : Sampling::exact);
        Annotator annotator(renderer);
        for (const double density : {0.0976, 0.07, 0.12, 0.3116, 0.28, 0.34}) {
            PaintOp op = flood_at(glm::dvec3(0.0), uniform(random, 10.0, 36.0), std::round(1000.0 * (1.0 - density)));
            op.connectivity = density < 0.2 ? 26 : 6;
            Size3 seed;
            do {
                seed = Size3(random() % uint64_t(size.x), random() % uint64_t(size.y), random() % uint64_t(size.z));
            } while (voxels.at(seed) < op.threshold);
            op.path = {glm::dvec3(seed) + glm::dvec3(uniform(random, 0, 1), uniform(random, 0, 1), 0.5)};
            for (const RegionShape region : {RegionShape::ball, RegionShape::box})
                for (const Brush brush : {Brush::flood, Brush::speckle}) {
                    op.brush = brush;
                    op.region = region;
                    check_against_reference(annotator, voxels, op);
                }
        }
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("brushes agree with breadth-first search on shapes made to mislead them")
{
    Renderer renderer(with_validation());
    constexpr int64_t SIDE = 64;
    using Open = std::function<bool(const Size3&)>;
    struct Shape {
        const char* name;
        Open open;
        glm::dvec3 seed{32.5};
    };
    const std::vector<Shape> shapes = {
        {"empty", [](const Size3&) { return false; }},
        {"full", [](const Size3&) { return true; }},
        {"single voxel", [](const Size3& v) { return v == Size3(31, 32, 33); }, {31.5, 32.5, 33.5}},
        {"checkerboard", [](const Size3& v) { return (v.x + v.y + v.z) % 2 == 0; }},
        {"serpentine", [](const Size3& v) { return is_serpentine(v, SIDE); }, {32.5, 32.5, 32.5}},
        {"comb", [](const Size3& v) { return v.y == 0 || (v.x % 2 == 0 && v.z % 2 == 0); }, {32.5, 63.5, 32.5}},
        {"comb along x", [](const Size3& v) { return v.x == 63 || (v.y % 2 == 0 && v.z % 2 == 0); }, {0.5, 32.5, 32.5}},
        {"double spiral", [](const Size3& v) { return spiral_arm(v, SIDE) != 0; }},
        {"brick edge", [](const Size3& v) { return (v.x < 32) == (v.y < 32); }},
        {"brick corner", [](const Size3& v) { return (v.x < 32) == (v.y < 32) && (v.y < 32) == (v.z < 32); }},
        {"other corner", [](const Size3& v) { return (v.x < 32) != (v.y < 32) && (v.y < 32) == (v.z < 32); }},
        {"bars to the faces", [](const Size3& v) { return is_bar_to_a_face(v, SIDE); }, {34.5, 34.5, 0.5}},
    };
    for (const Shape& shape : shapes) {
        CAPTURE(std::string(shape.name));
        const Voxels voxels = pattern(Size3(SIDE), shape.open);
        load(renderer, voxels);
        Annotator annotator(renderer);
        PaintOp op = flood_at(shape.seed, 64.0);
        for (const RegionShape region : {RegionShape::ball, RegionShape::box})
            for (const int connectivity : {6, 26})
                for (const Brush brush : {Brush::flood, Brush::speckle}) {
                    op.region = region;
                    op.connectivity = connectivity;
                    op.brush = brush;
                    check_against_reference(annotator, voxels, op);
                }
        check_all_brushes(annotator, voxels, flood_at(shape.seed + glm::dvec3(0.3, -0.2, 0.1), 13.0));
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("flood and speckle fill find what shapes are known to hold")
{
    Renderer renderer(with_validation());
    constexpr int64_t SIDE = 40;
    const auto count = [&](Annotator& annotator, PaintOp op, Brush brush, int connectivity) {
        op.brush = brush;
        op.connectivity = connectivity;
        return annotator.select(op).count();
    };
    {
        load(renderer, pattern(Size3(SIDE), [](const Size3& v) { return (v.x + v.y + v.z) % 2 == 0; }));
        Annotator annotator(renderer);
        const PaintOp op = flood_at(glm::dvec3(20.0), 20.0);
        CHECK(count(annotator, op, Brush::flood, 6) == 1);
        CHECK(count(annotator, op, Brush::flood, 26) == SIDE * SIDE * SIDE / 2);
        CHECK(count(annotator, op, Brush::speckle, 6) == 38 * 38 * 38 / 2);
        CHECK(count(annotator, op, Brush::speckle, 26) == 0);
    }
    {
        load(renderer, pattern(Size3(SIDE), [](const Size3& v) { return is_serpentine(v, SIDE); }));
        Annotator annotator(renderer);
        // 20 slices of 20 rows and 19 links between them; above each slice a link, the last of which leads nowhere.
        CHECK(count(annotator, flood_at({0.5, 0.5, 0.5}, 64.0), Brush::flood, 6) == 20 * (20 * 40 + 19) + 20);
    }
    {
        load(renderer, pattern(Size3(SIDE), [](const Size3& v) { return is_bar_to_a_face(v, SIDE); }));
        Annotator annotator(renderer);
        CHECK(count(annotator, flood_at(glm::dvec3(20.0), 20.0), Brush::speckle, 26) == 6 * 7);
        // A region one voxel smaller all around: the short bars now reach its edge as well.
        CHECK(count(annotator, flood_at(glm::dvec3(20.0), 19.0), Brush::speckle, 26) == 0);
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("regions cross borders of bricks, words and the volume")
{
    Renderer renderer(with_validation());
    std::mt19937 random(52);  // seed 52; volume: 520
    Voxels voxels = noise({110, 44, 39}, 520);
    voxels.spacing = {1.0, 0.8, 1.7};
    load(renderer, voxels);
    Annotator annotator(renderer);
    check_all_brushes(annotator, voxels, flood_at({55.0, 20.5, 20.5}, 35.0, 690.0));  // x from 20 to 90
    for (const double x : {0.2, 31.9, 32.0, 33.0, 63.5, 64.0, 109.9}) {
        const double density = x < 40.0 ? 0.32 : 0.1;
        check_all_brushes(annotator, voxels,
                          flood_at({x, uniform(random, 0.0, 44.0), uniform(random, 0.0, 39.0)},
                                   uniform(random, 0.4, 20.0), std::round(1000.0 * (1.0 - density))));
    }
    for (const Size3& size : {Size3(1), Size3(2, 1, 3), Size3(100, 1, 1), Size3(1, 70, 33)}) {
        const Voxels thin = noise(size, 521);  // seed 521
        load(renderer, thin);
        Annotator thin_annotator(renderer);
        check_all_brushes(thin_annotator, thin, flood_at(glm::dvec3(size) / 2.0, 40.0, 400.0));
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("a seed outside the volume, outside the region or below the threshold floods nothing")
{
    Renderer renderer(with_validation());
    const Voxels voxels = pattern({40, 30, 20}, [](const Size3& v) { return v != Size3(20, 15, 10); });
    load(renderer, voxels);
    Annotator annotator(renderer);
    for (const glm::dvec3& outside :
         {glm::dvec3(-0.5, 15.0, 10.0), glm::dvec3(40.0, 15.0, 10.0), glm::dvec3(20.0, 30.0, 10.0),
          glm::dvec3(20.0, 15.0, -1e-9), glm::dvec3(1e12, 0.0, 0.0), glm::dvec3(20.5, 15.5, 10.5)}) {
        CHECK(annotator.select(flood_at(outside, 8.0)).count() == 0);
        PaintOp fill = flood_at(outside, 8.0);
        fill.brush = Brush::fill;
        CHECK((annotator.select(fill).count() > 0) == (outside.x < 100.0));
    }
    CHECK(annotator.select(flood_at({10.9, 10.9, 10.9}, 0.3)).count() == 0);  // no voxel centre is that close
    for (const glm::dvec3& border : {glm::dvec3(0.0), glm::dvec3(39.999, 29.999, 19.999), glm::dvec3(0.0, 29.5, 0.5)})
        CHECK(check_against_reference(annotator, voxels, flood_at(border, 8.0)) > 0);
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("a voxel at exactly the threshold is open, whatever the voxel type")
{
    Renderer renderer(with_validation());
    const Size3 size(36, 9, 7);
    struct Case {
        VoxelType type;
        double lowest, step;
        std::vector<double> thresholds;
    };
    // float32: quarters from 0 to 65535 / 4 are codes exactly.
    const std::vector<Case> cases = {
        {VoxelType::uint8, 0.0, 1.0, {0.0, 1.0, 127.0, 254.5, 255.0, 256.0, -3.0}},
        {VoxelType::int8, -128.0, 1.0, {-128.0, -127.5, -1.0, 0.0, 127.0, 128.0}},
        {VoxelType::uint16, 0.0, 29.0, {0.0, 29.0, 30.0, 32741.0, 65535.0, 1e6}},
        {VoxelType::int16, -32768.0, 29.0, {-32768.0, -32739.0, -32738.0, -1000.0, -27.0, 32767.0}},
        {VoxelType::int16, -1000.0, 1.0, {-1000.0, -999.0, -500.0, -0.5, 0.0, 200.0}},
        {VoxelType::float32, 0.0, 0.25, {0.0, 0.25, 0.3, 100.0, 16383.75, 16384.0}},
    };
    for (const Case& c : cases) {
        const double most = c.step == 29.0                                            ? 2259.0
                            : c.type == VoxelType::uint8 || c.type == VoxelType::int8 ? 255.0
                                                                                      : 2267.0;
        Voxels voxels{.size = size, .type = c.type};
        for (int64_t i = 0; i < size.x * size.y * size.z; ++i)
            voxels.values.push_back(c.lowest + c.step * std::min(double(i * 389 % 2268), most));
        // Two, because a single one would be an outlier outside the window.
        if (c.type == VoxelType::float32) voxels.values.back() = voxels.values[voxels.values.size() - 2] = 16383.75;
        for (const Sampling sampling : {Sampling::exact, Sampling::hardware}) {
            if (sampling == Sampling::hardware && !filters_in_hardware(renderer)) continue;
            load(renderer, voxels, sampling);
            Annotator annotator(renderer);
            CAPTURE(std::string(name_of(c.type)));
            for (const double threshold : c.thresholds) {
                PaintOp op = flood_at({18.0, 4.5, 3.5}, 30.0, threshold);
                for (const Brush brush : {Brush::fill, Brush::flood}) {
                    op.brush = brush;
                    check_against_reference(annotator, voxels, op);
                }
            }
        }
    }
    CHECK(messages_of(renderer) == "");
}

// Kind (Values): thresholds between values that share a 16-bit code
TEST_CASE("values that share a code are told apart, next to fill values and under offsets, too")
{
    Renderer renderer(with_validation());
    struct Case {
        VoxelType type;
        double step, fill;
    };
    for (const Case& c :
         {Case{VoxelType::int32, 1.0, -2147483648.0}, Case{VoxelType::int32, 1.0, 2147483647.0},
          Case{VoxelType::float32, 0.0009765625, double(-3.4e38f)}, Case{VoxelType::float64, 1e-9, 1e7}}) {
        CAPTURE(std::string(name_of(c.type)));
        CAPTURE(c.fill);
        std::mt19937 random(56);
        const Voxels voxels = voxels_of({40, 37, 35}, c.type, [&](const Size3& v) {
            return (v.x + v.y) % 3 == 0 ? c.fill : c.step * double(random() % 2000000);
        });
        load(renderer, voxels);
        Annotator annotator(renderer);
        for (const double threshold : {c.step * 900000.0, c.step * 900000.5, c.step * 1400001.0})
            for (const Brush brush : {Brush::fill, Brush::flood, Brush::speckle}) {
                PaintOp op = flood_at({20.0, 18.5, 17.5}, 30.0, threshold);
                op.brush = brush;
                op.region = brush == Brush::speckle ? RegionShape::ball : RegionShape::box;
                op.path.push_back({21.0, 19.5, 17.5});
                check_against_reference(annotator, voxels, op);
            }
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("a region of 128 voxels a side is flooded voxel for voxel")
{
    Renderer renderer(with_validation());
    Voxels voxels = noise(Size3(128), 53);  // seed 53
    load(renderer, voxels);
    Annotator annotator(renderer);
    PaintOp op = flood_at(glm::dvec3(64.0), 64.0, 640.0);
    // Most open voxels at this density belong to one component; a seed in a small one would prove little.
    while (annotator.select(op).count() < 100000) op.path[0] += 1.0;
    check_against_reference(annotator, voxels, op);
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("equal strokes select equal voxels, run after run")
{
    Renderer renderer(with_validation());
    load(renderer, noise(Size3(64), 54));  // seed 54
    Annotator annotator(renderer);
    for (const Brush brush : {Brush::flood, Brush::speckle}) {
        PaintOp op = flood_at(glm::dvec3(32.5), 32.0, 680.0);
        op.brush = brush;
        op.path = {glm::dvec3(30.5), glm::dvec3(34.5, 30.5, 32.5)};
        const VoxelSelection first = annotator.select(op);
        for (int run = 1; run < 5; ++run) CHECK(annotator.select(op).bricks() == first.bricks());
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("a stroke selects what its positions select, and is one command")
{
    Renderer renderer(with_validation());
    Voxels voxels = noise({70, 40, 40}, 55);  // seed 55
    voxels.spacing = {1.0, 1.0, 3.0};
    load(renderer, voxels);
    Annotator annotator(renderer);
    PaintOp op = flood_at(glm::dvec3(0.0), 5.0, 400.0);
    op.path = {{-4.0, 5.0, 5.0}, {40.0, 20.0, 12.0}, {75.0, 20.0, 50.0}};
    for (const Brush brush : {Brush::fill, Brush::flood, Brush::speckle}) {
        op.brush = brush;
        const int64_t voxels_selected = check_against_reference(annotator, voxels, op);
        if (brush != Brush::flood) continue;
        CHECK(annotator.paint(op) == voxels_selected);
        CHECK(annotator.history().undoable() == 1);
        CHECK(annotator.undo() != nullptr);
        CHECK(annotator.document().mask.painted_bricks().empty());
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("a stroke by hand paints what a script's stroke paints, and is one command")
{
    Renderer renderer(with_validation());
    Voxels voxels = noise({70, 40, 40}, 56);  // seed 56
    load(renderer, voxels);
    Annotator by_script(renderer), by_hand(renderer);
    PaintOp op = flood_at(glm::dvec3(0.0), 5.0, 400.0);
    op.path = {{-4.0, 5.0, 5.0}, {40.0, 20.0, 12.0}, {40.0, 20.0, 12.0}, {75.0, 20.0, 30.0}, {60.0, 25.0, 30.0}};
    const int64_t painted = by_script.paint(op);
    REQUIRE(painted > 1000);

    by_hand.begin_stroke(op);
    for (size_t i = 0; i < op.path.size(); ++i) {
        by_hand.extend_stroke(op.path[i]);
        for (size_t turns = 0; turns < i * 1000; ++turns) by_hand.advance();
    }
    CHECK(by_hand.undo() == nullptr);  // a stroke is running
    by_hand.end_stroke();
    int64_t reported = 0;
    while (by_hand.stroke_is_running())
        if (const auto box = by_hand.advance()) reported += box->size().x * box->size().y * box->size().z;
    CHECK(reported > 0);
    CHECK(by_hand.last_stroke().voxels() == painted);
    CHECK(by_hand.document().mask.voxels_by_group() == by_script.document().mask.voxels_by_group());
    for (const int64_t brick : by_script.document().mask.painted_bricks())
        CHECK(*by_hand.document().mask.brick(brick) == *by_script.document().mask.brick(brick));
    CHECK(by_hand.history().undoable() == 1);
    CHECK(by_hand.undo() != nullptr);
    CHECK(by_hand.document().mask.painted_bricks().empty());
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("a stroke eight times as long needs no more memory")
{
    Renderer renderer(with_validation());
    load(renderer, pattern(Size3(64), [](const Size3&) { return true; }));
    Annotator annotator(renderer);
    const auto select_rows = [&](int rows) {
        PaintOp op = flood_at(glm::dvec3(0.5), 1.0);
        op.path.clear();
        for (int row = 0; row < rows; ++row)
            for (const double x : {0.5, 63.5}) op.path.emplace_back(row % 2 == 0 ? x : 64.0 - x, row + 0.5, 0.5);
        CHECK(stroke_positions(op.path).size() == size_t(64 * rows));
        CHECK(annotator.select(op).count() == 64 * (rows + 1) * 2);
        return renderer.memory().peak_device_bytes();
    };
    const uint64_t peak = select_rows(6);
    CHECK(select_rows(48) == peak);
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("undo and redo bring back mask and picture, bit for bit")
{
    Renderer renderer(with_validation());
    load(renderer, voxels_of(Size3(48), VoxelType::uint8, [](const Size3& v) { return double(v.x + v.y + v.z); }));
    Annotator annotator(renderer);
    Session session = plain_session();
    session.light.shaded = true;
    session.transfer_function =
        TransferFunction({{20.0, glm::dvec3(1.0, 0.5, 0.2), 0.0}, {140.0, glm::dvec3(0.2, 0.5, 1.0), 0.05}});
    std::vector<std::vector<float>> pictures = {picture(renderer, session)};
    std::vector<std::vector<uint8_t>> masks = {groups_of(annotator.document().mask)};
    CHECK(mask_bytes(renderer) == 0);
    CHECK(!annotator.undo());
    std::mt19937 random(56);  // seed 56
    for (int i = 0; i < 6; ++i) {
        PaintOp op = flood_at(glm::dvec3(uniform(random, 10, 40), uniform(random, 10, 40), uniform(random, 10, 40)),
                              uniform(random, 5, 15), 40.0);
        op.group = uint8_t(1 + i % 3);
        CHECK(annotator.paint(op) > 0);
        pictures.push_back(picture(renderer, session));
        masks.push_back(groups_of(annotator.document().mask));
        CHECK(pictures.back() != pictures[pictures.size() - 2]);
    }
    CHECK(mask_bytes(renderer) > 0);
    for (int round = 0; round < 2; ++round) {
        for (size_t i = 6; i-- > 0;) {
            CHECK(annotator.undo() != nullptr);
            CHECK(masks[i] == groups_of(annotator.document().mask));
            check_below("differing values of the picture", double(differing(pictures[i], picture(renderer, session))),
                        0.0);
        }
        CHECK(!annotator.undo());
        CHECK(mask_bytes(renderer) == 0);
        for (size_t i = 1; i <= 6; ++i) {
            CHECK(annotator.redo() != nullptr);
            CHECK(masks[i] == groups_of(annotator.document().mask));
            check_below("differing values of the picture", double(differing(pictures[i], picture(renderer, session))),
                        0.0);
        }
        CHECK(!annotator.redo());
    }
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("paint counts the voxels it changed; later paint overwrites, group 0 erases")
{
    Renderer renderer(with_validation());
    load(renderer, pattern(Size3(40), [](const Size3&) { return true; }));
    Annotator annotator(renderer);
    const auto in_group = [&](uint8_t group) { return annotator.document().mask.voxels_by_group()[group]; };
    CHECK(annotator.paint(fill_at(glm::dvec3(20.0), 5.0, 3)) == 1000);
    CHECK(annotator.paint(fill_at(glm::dvec3(20.0), 5.0, 3)) == 0);
    CHECK(annotator.history().undoable() == 1);  // nothing changed, nothing to undo
    CHECK(annotator.paint(fill_at({20.0, 20.0, 25.0}, 5.0, 4)) == 1000);
    CHECK(in_group(3) == 500);
    CHECK(in_group(4) == 1000);
    CHECK(annotator.paint(fill_at({20.0, 20.0, 30.0}, 5.0, 0)) == 500);
    CHECK(in_group(4) == 500);
    CHECK(in_group(0) == 40 * 40 * 40 - 1000);
    CHECK(annotator.document().mask.at({20, 20, 19}) == 3);
    CHECK(annotator.document().mask.at({20, 20, 20}) == 4);
    CHECK(annotator.document().mask.at({20, 20, 25}) == 0);
    CHECK(annotator.paint(fill_at(glm::dvec3(20.0), 30.0, 0)) == 1000);
    CHECK(mask_bytes(renderer) == 0);
    CHECK(annotator.undo() != nullptr);
    CHECK(in_group(3) == 500);
    CHECK(mask_bytes(renderer) > 0);
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("painted voxels have their group's colour, hidden ones are not drawn")
{
    Renderer renderer(with_validation());
    // 50 lies outside the transfer function, 150 inside.
    load(renderer, voxels_of(Size3(40), VoxelType::uint8, [](const Size3& v) { return v.x < 20 ? 50.0 : 150.0; }));
    Annotator annotator(renderer);
    Session session = plain_session();
    session.groups[2] = {.name = "blue", .color = glm::dvec3(0.0, 0.25, 1.0), .opacity = 1.0, .visible = true};
    const glm::vec4 white(1.0f), red(1.0f, 0.0f, 0.0f, 1.0f), blue(0.0f, 0.25f, 1.0f, 1.0f);
    const auto is_near = [](const glm::vec4& a, const glm::vec4& b) { return glm::length(a - b) < 0.003f; };
    std::vector<float> seen = picture(renderer, session);
    CHECK(is_near(pixel(seen, 18, 24), white));
    CHECK(is_near(pixel(seen, 30, 24), red));

    CHECK(annotator.paint(fill_at(glm::dvec3(20.0), 8.0, 2)) == 16 * 16 * 16);
    seen = picture(renderer, session);
    CHECK(is_near(pixel(seen, 20, 24), blue));  // made visible
    CHECK(is_near(pixel(seen, 35, 24), red));

    CHECK(annotator.paint(fill_at(glm::dvec3(20.0), 40.0, 2)) > 0);
    session.groups[2].visible = false;
    seen = picture(renderer, session);
    CHECK(is_near(pixel(seen, 20, 24), white));
    CHECK(is_near(pixel(seen, 30, 24), white));
    session.groups[2].visible = true;
    CHECK(is_near(pixel(picture(renderer, session), 30, 24), blue));
    CHECK(messages_of(renderer) == "");
}

TEST_CASE("a mask that grew brick by brick looks like one loaded at once")
{
    const TemporaryFolder folder;
    const Voxels voxels =
        voxels_of({160, 100, 130}, VoxelType::uint8, [](const Size3& v) { return double(v.x + v.y) / 2.0; });
    Session session = plain_session();
    session.transfer_function =
        TransferFunction({{0.0, glm::dvec3(1.0, 0.5, 0.2), 0.001}, {140.0, glm::dvec3(0.2, 0.5, 1.0), 0.01}});
    for (int group = 1; group < 256; ++group)
        session.groups[uint8_t(group)] = {
            .name = "", .color = glm::dvec3(group % 7, group % 5, group % 3) / 7.0, .opacity = 0.02};
    Renderer grown(with_validation());
    load(grown, voxels);
    Annotator annotator(grown);
    CHECK(annotator.open({.mask = folder.path / "a.mask", .volume = grown.volume().info()}).empty());
    std::mt19937 random(57);  // seed 57
    uint64_t bytes = 0;
    int growths = 0;
    for (int i = 0; i < 60; ++i) {
        const glm::dvec3 at(uniform(random, 0, 160), uniform(random, 0, 100), uniform(random, 0, 130));
        annotator.paint(fill_at(at, uniform(random, 2.0, 12.0), uint8_t(random() % 8)));
        if (i % 7 == 6) annotator.undo();
        growths += mask_bytes(grown) > bytes;
        bytes = mask_bytes(grown);
    }
    CHECK(growths >= 3);
    annotator.work().save();
    Renderer fresh(with_validation());
    load(fresh, voxels);
    Annotator loaded(fresh);
    CHECK(loaded.open({.mask = folder.path / "a.mask", .volume = fresh.volume().info()}).empty());
    CHECK(groups_of(loaded.document().mask) == groups_of(annotator.document().mask));
    CHECK((picture(grown, session) == picture(fresh, session)));
    while (annotator.undo()) {
    }
    CHECK(mask_bytes(grown) == 0);
    CHECK(messages_of(grown) == "");
    CHECK(messages_of(fresh) == "");
}
