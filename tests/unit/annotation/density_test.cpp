// Density painting against a brute force in double: every voxel, every position, the rule in order.

#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/density_brush.h"
#include "engine/annotation/work/history.h"
#include "engine/base/error.h"
#include "tests/support/bounds.h"

using namespace shvr;

namespace {

constexpr Size3 SIZE(45, 40, 35);  // no multiple of a brick's side
constexpr glm::dvec3 SPACING(1.0, 1.25, 0.8);

struct Dab {
    RegionShape shape;
    glm::dvec3 centre;
    double radius;
    std::vector<uint32_t> words;  ///< bits of the region's voxels
};
struct Stroke {
    double offset;
    Falloff falloff;
    std::vector<Dab> dabs;
};

BrushRegion region_of(const Dab& dab)
{
    return make_region(dab.shape, dab.centre, dab.radius, SPACING, SIZE);
}

Stroke random_stroke(std::mt19937& random, double most)
{
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Stroke stroke{
        random() % 6 == 0 ? 0.0 : uniform(-most, most), random() % 2 == 0 ? Falloff::flat : Falloff::distance, {}};
    for (auto dabs = 1 + random() % 4; dabs > 0; --dabs) {
        Dab dab{random() % 2 == 0 ? RegionShape::ball : RegionShape::box,
                {uniform(-2, 47), uniform(-2, 42), uniform(-2, 37)},
                uniform(0.5, 12.0),
                {}};
        const BrushRegion region = region_of(dab);
        dab.words.resize(size_t(region.words_per_row()) * region.rows.size());
        const bool is_whole = random() % 2 == 0;
        for (uint32_t& word : dab.words) word = is_whole ? ~0u : uint32_t(random());
        stroke.dabs.push_back(std::move(dab));
    }
    return stroke;
}

std::vector<Change> changes_of(const Stroke& stroke, const DensityField& field)
{
    DensityStroke painted(SIZE, SPACING, field.type(), stroke.offset, stroke.falloff);
    for (const Dab& dab : stroke.dabs) painted.add(region_of(dab), dab.words, dab.centre, dab.radius);
    return as_changes(painted.changes(field));
}

void apply_all(DensityField& field, const std::vector<Change>& changes, Direction direction)
{
    if (direction == Direction::forwards)
        for (const Change& change : changes) field.apply(std::get<DensityBrickChange>(change), direction);
    else
        for (auto change = changes.rbegin(); change != changes.rend(); ++change)
            field.apply(std::get<DensityBrickChange>(*change), direction);
}

/// An offset as a volume of that type stores it.
double kept(VoxelType type, double offset)
{
    const double limit = type == VoxelType::uint8    ? 255.0
                         : type == VoxelType::int16  ? 65535.0
                         : type == VoxelType::uint32 ? 2147483647.0
                                                     : 3.4028234663852886e38;
    const double within = std::clamp(offset, -limit, limit);
    return is_float(type) ? double(float(within)) : std::round(within);
}

using Offsets = std::vector<double>;

/// The rule, position by position.
void paint_by_force(Offsets& offsets, const Stroke& stroke, VoxelType type)
{
    const double most = kept(type, stroke.offset);
    for (const Dab& dab : stroke.dabs) {
        const BrushRegion region = region_of(dab);
        size_t index = 0;
        for (int64_t z = 0; z < SIZE.z; ++z)
            for (int64_t y = 0; y < SIZE.y; ++y)
                for (int64_t x = 0; x < SIZE.x; ++x, ++index) {
                    if (!region.contains({x, y, z})) continue;
                    const Size3 at = Size3(x, y, z) - region.box.lower;
                    const auto row = at.y + region.box.size().y * at.z;
                    const uint32_t word = dab.words[size_t(region.words_per_row() * row + at.x / 32)];
                    if ((word >> (at.x % 32) & 1) == 0) continue;
                    const glm::dvec3 way = (glm::dvec3(x, y, z) + 0.5 - dab.centre) * SPACING;
                    const double share = std::max(0.0, 1.0 - glm::length(way) / (dab.radius * SPACING.x));
                    const double here = stroke.falloff == Falloff::flat ? most : kept(type, stroke.offset * share);
                    double& offset = offsets[index];
                    offset =
                        most >= 0.0 ? std::max(here, std::min(offset, most)) : std::min(here, std::max(offset, most));
                }
    }
}

int64_t differing(const DensityField& field, const Offsets& offsets)
{
    int64_t wrong = 0;
    size_t index = 0;
    for (int64_t z = 0; z < SIZE.z; ++z)
        for (int64_t y = 0; y < SIZE.y; ++y)
            for (int64_t x = 0; x < SIZE.x; ++x) wrong += field.at({x, y, z}) != offsets[index++];
    return wrong;
}

/// The complete content.
std::map<int64_t, OffsetBrick> content_of(const DensityField& field)
{
    std::map<int64_t, OffsetBrick> bricks;
    for (const int64_t index : field.painted_bricks()) bricks[index] = *field.brick(index);
    return bricks;
}

}  // namespace

TEST_CASE("strokes of offsets equal the rule applied voxel by voxel in double, and are undone bit for bit")
{
    for (const VoxelType type : {VoxelType::uint8, VoxelType::int16, VoxelType::uint32, VoxelType::float32}) {
        CAPTURE(std::string(name_of(type)));
        const double most = type == VoxelType::uint8 ? 300.0 : type == VoxelType::uint32 ? 3e9 : 70000.0;
        std::mt19937 random(7);
        DensityField field(SIZE, type);
        Offsets expected(size_t(SIZE.x * SIZE.y * SIZE.z));
        std::vector<std::vector<Change>> history;
        std::vector<std::map<int64_t, OffsetBrick>> states{content_of(field)};
        for (int i = 0; i < 12; ++i) {
            const Stroke stroke = random_stroke(random, most);
            history.push_back(changes_of(stroke, field));
            apply_all(field, history.back(), Direction::forwards);
            paint_by_force(expected, stroke, type);
            states.push_back(content_of(field));
            CAPTURE(i);
            test::check_below("differing voxels", double(differing(field, expected)), 0.0);
            CHECK(field.voxels() == std::count_if(expected.begin(), expected.end(), [](double o) { return o != 0.0; }));
            CHECK(changes_of(stroke, field).empty());  // repeating it changes nothing
        }
        REQUIRE(field.voxels() > 1000);
        for (size_t i = history.size(); i-- > 0;) {
            apply_all(field, history[i], Direction::backwards);
            test::check_below("states that undo does not bring back", content_of(field) == states[i] ? 0.0 : 1.0, 0.0);
        }
        CHECK(field.painted_bricks().empty());
        CHECK(field.voxels() == 0);
        for (size_t i = 0; i < history.size(); ++i) apply_all(field, history[i], Direction::forwards);
        CHECK((content_of(field) == states.back()));
    }
}

TEST_CASE("the order of positions within a stroke does not matter, nor that they come in parts")
{
    std::mt19937 random(11);
    for (int i = 0; i < 10; ++i) {
        DensityField field(SIZE, VoxelType::uint16);
        apply_all(field, changes_of(random_stroke(random, 900.0), field), Direction::forwards);
        DensityField other = field, parts = field;
        Stroke stroke = random_stroke(random, 900.0);
        apply_all(field, changes_of(stroke, field), Direction::forwards);
        std::ranges::reverse(stroke.dabs);
        apply_all(other, changes_of(stroke, other), Direction::forwards);
        for (const Dab& dab : stroke.dabs)
            apply_all(parts, changes_of({stroke.offset, stroke.falloff, {dab}}, parts), Direction::forwards);
        CHECK((content_of(field) == content_of(other)));
        CHECK((content_of(field) == content_of(parts)));
    }
}

TEST_CASE("painting lowers higher offsets, keeps what lies between, and resets with 0")
{
    const auto painted = [](double old, double most, double here) {
        const VoxelType type = VoxelType::int16;
        return offset_of(
            type, painted_offset(type, offset_bits(type, old), offset_bits(type, most), offset_bits(type, here)));
    };
    CHECK(painted(0, 40, 40) == 40);
    CHECK(painted(60, 40, 10) == 40);
    CHECK(painted(30, 40, 10) == 30);
    CHECK(painted(5, 40, 10) == 10);
    CHECK(painted(-20, 40, 10) == 10);
    CHECK(painted(-60, -40, -10) == -40);
    CHECK(painted(-30, -40, -10) == -30);
    CHECK(painted(20, -40, -10) == -10);
    for (const double old : {-700.0, -1.0, 0.0, 1.0, 65535.0}) CHECK(painted(old, 0, 0) == 0);
}

TEST_CASE("a thousand dabs on one place leave the offset that one leaves")
{
    DensityField field(SIZE, VoxelType::uint8);
    Dab dab{RegionShape::ball, {20, 20, 20}, 5.0, {}};
    dab.words.assign(size_t(region_of(dab).words_per_row()) * region_of(dab).rows.size(), ~0u);
    const Stroke stroke{10.0, Falloff::flat, {dab}};
    for (int i = 0; i < 1000; ++i) apply_all(field, changes_of(stroke, field), Direction::forwards);
    test::check_below("off one dab's offset", std::abs(field.at({20, 20, 20}) - 10.0), 0.0);
}

TEST_CASE("the automatic offset lifts the paint threshold to the lowest point, and never lowers")
{
    CHECK(automatic_offset(120.0, 90.0) == 30.0);
    CHECK(automatic_offset(120.0, 150.0) == 0.0);
}

TEST_CASE("offsets are rounded to what the type keeps, and 0 has one form")
{
    CHECK(offset_of(VoxelType::uint8, offset_bits(VoxelType::uint8, 2.5)) == 3.0);
    CHECK(offset_of(VoxelType::uint8, offset_bits(VoxelType::uint8, -2.5)) == -3.0);
    CHECK(offset_of(VoxelType::uint8, offset_bits(VoxelType::uint8, 1e300)) == 255.0);
    CHECK(offset_of(VoxelType::uint16, offset_bits(VoxelType::uint16, -1e300)) == -65535.0);
    CHECK(offset_of(VoxelType::int32, offset_bits(VoxelType::int32, 2147483647.0)) == 2147483647.0);
    CHECK(offset_of(VoxelType::float32, offset_bits(VoxelType::float32, 0.1)) == double(0.1f));
    CHECK(offset_bits(VoxelType::float32, -0.0) == 0);
    CHECK(offset_bits(VoxelType::float64, -1e-60) == 0);
    CHECK(offset_bits(VoxelType::uint8, -0.25) == 0);
}

TEST_CASE("a field never changes a brick that somebody holds, and an offset must be a number")
{
    DensityField field(SIZE, VoxelType::uint8);
    field.apply({.brick = 0, .runs = {{0, 9, 0, 5}}}, Direction::forwards);
    const std::shared_ptr<const OffsetBrick> held = field.brick(0);
    field.apply({.brick = 0, .runs = {{3, 4, 5, 7}}}, Direction::forwards);
    CHECK((*held)[3] == 5);
    CHECK((*field.brick(0))[3] == 7);
    CHECK_THROWS_AS(DensityStroke(SIZE, SPACING, VoxelType::uint8, std::nan(""), Falloff::flat), Error);
}

TEST_CASE("the reach of a record holds every voxel of it and no more rows than it must")
{
    const DensityField field(SIZE, VoxelType::uint8);
    CHECK((field.reach_of({.brick = 0, .runs = {{3, 5, 0, 1}}}) == VoxelBox{{3, 0, 0}, {6, 1, 1}}));
    CHECK((field.reach_of({.brick = 1, .runs = {{2 + 32, 4 + 32, 0, 1}, {1 + 1024, 1 + 1024, 0, 1}}}) ==
           VoxelBox{{33, 0, 0}, {37, 2, 2}}));
    CHECK((field.reach_of({.brick = 0, .runs = {{31, 32, 0, 1}}}) == VoxelBox{{0, 0, 0}, {32, 2, 1}}));
    CHECK((field.reach_of({.brick = 1, .runs = {{31, 1024, 0, 1}}}) == VoxelBox{{32, 0, 0}, {45, 32, 2}}));
}
