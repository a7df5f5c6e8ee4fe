// The leap grid, read back from the device, against its definition by brute force: which cells may be visible under a
// transfer function, and how far away the nearest of them is.

#include "engine/passes/leap_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <doctest/doctest.h>

#include "engine/device/resident_volume.h"
#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

struct Grid {
    glm::ivec3 counts{0};
    std::vector<uint32_t> entries;
    uint32_t distance(const glm::ivec3& cell) const
    {
        return entries[size_t(cell.x + counts.x * (cell.y + counts.y * cell.z))] >> gpu::LEAP_DISTANCE_SHIFT;
    }
};

/// Draws, so that the renderer builds the grid, and reads it back.
Grid grid_of(OnDevice& device, const Session& session)
{
    device.draw(session, camera_looking("front", device.volume().info()));
    FrameGraph graph;
    const VolumeBinding volume = dynamic_cast<ResidentVolume&>(device.renderer().volume()).import(graph);
    const uint32_t back = graph.read_back(volume.leap);
    const gpu::FrameResult result = device.renderer().executor().run(graph);
    Grid grid{.counts = glm::ivec3(volume.cell_counts)};
    grid.entries.resize(result.read_backs[back].size() / sizeof(uint32_t));
    std::memcpy(grid.entries.data(), result.read_backs[back].data(), result.read_backs[back].size());
    return grid;
}

constexpr uint32_t REST = gpu::LEAP_PAINTED | gpu::LEAP_SLOT_MASK;

template <class Visit>
void for_each_cell(const glm::ivec3& counts, const Visit& visit)
{
    for (int z = 0; z < counts.z; ++z)
        for (int y = 0; y < counts.y; ++y)
            for (int x = 0; x < counts.x; ++x) visit(glm::ivec3(x, y, z));
}

/// Chebyshev distance to the nearest cell at distance 0, at most LEAP_LIMIT: the definition, cell by cell.
uint32_t nearest_occupied(const Grid& grid, const glm::ivec3& cell)
{
    uint32_t best = gpu::LEAP_LIMIT;
    const glm::ivec3 reach(gpu::LEAP_LIMIT - 1);
    const glm::ivec3 lower = glm::max(cell - reach, 0), upper = glm::min(cell + reach, grid.counts - 1);
    for_each_cell(upper - lower + 1, [&](const glm::ivec3& offset) {
        const glm::ivec3 other = lower + offset, apart = glm::abs(other - cell);
        if (grid.distance(other) == 0) best = std::min(best, uint32_t(std::max({apart.x, apart.y, apart.z})));
    });
    return best;
}

void check_distances(const Grid& grid)
{
    size_t wrong = 0, occupied = 0;
    for_each_cell(grid.counts, [&](const glm::ivec3& cell) {
        occupied += grid.distance(cell) == 0;
        wrong += grid.distance(cell) != nearest_occupied(grid, cell);
    });
    CAPTURE(occupied);
    CHECK(wrong == 0);
}

/// Minimum and maximum code that a sample in the cell can read; edge voxels repeat outside the volume.
glm::dvec2 range_of(const TestVolume& volume, const glm::ivec3& cell)
{
    glm::dvec2 range(65535.0, 0.0);
    for_each_cell(glm::ivec3(int(gpu::CELL_SIZE) + 2), [&](const glm::ivec3& offset) {
        const glm::ivec3 voxel = glm::clamp(int(gpu::CELL_SIZE) * cell + offset - 1, glm::ivec3(0), volume.size - 1);
        const double code = volume.voxels[size_t(voxel.x + volume.size.x * (voxel.y + volume.size.y * voxel.z))];
        range = {std::min(range.x, code), std::max(range.y, code)};
    });
    return range;
}

/// A cell must be occupied if the function shows something well within its range, and empty if it shows nothing even
/// slightly outside it.
void check_occupancy(const TestVolume& volume, const Session& session, const Grid& grid)
{
    const TransferFunction& function = session.transfer_function;
    const double entry = (function.upper() - function.lower()) / (MIN_TABLE_ENTRIES - 1);
    const double margin = 1.01 * entry + 0.2;  // a table's entry, and a guard against rounding
    const auto shows = [&](double from, double to) {
        for (const ControlPoint& point : function.points())
            if (point.opacity > 0.0 && point.intensity >= from && point.intensity <= to) return true;
        return function.at(from).a > 0.0 || function.at(to).a > 0.0;
    };
    size_t lost = 0, idle = 0;
    for_each_cell(grid.counts, [&](const glm::ivec3& cell) {
        const glm::dvec2 range = range_of(volume, cell);
        const bool is_occupied = grid.distance(cell) == 0;
        lost += shows(range.x, range.y) && !is_occupied;
        idle += !shows(range.x - margin, range.y + margin) && is_occupied;
    });
    CHECK(lost == 0);
    CHECK(idle == 0);
}

/// A cell is painted if any of its voxels is in a group.
void check_painted(const Grid& grid, const Mask& mask)
{
    size_t wrong = 0;
    for_each_cell(grid.counts, [&](const glm::ivec3& cell) {
        bool is_painted = false;
        for_each_cell(glm::ivec3(gpu::CELL_SIZE), [&](const glm::ivec3& offset) {
            const Size3 voxel = Size3(int(gpu::CELL_SIZE) * cell + offset);
            if (glm::all(glm::lessThan(voxel, mask.size()))) is_painted = is_painted || mask.at(voxel) != 0;
        });
        const size_t index = size_t(cell.x + grid.counts.x * (cell.y + grid.counts.y * cell.z));
        wrong += is_painted != ((grid.entries[index] & gpu::LEAP_PAINTED) != 0);
    });
    CHECK(wrong == 0);
}

/// Voxels of 50000 at the given places, 1000 elsewhere.
TestVolume dots(const glm::ivec3& size, const std::vector<glm::ivec3>& places)
{
    TestVolume volume = constant_volume(size, 1000.0);
    for (const glm::ivec3& place : places)
        volume.voxels[size_t(place.x + size.x * (place.y + size.y * place.z))] = 50000.0;
    return volume;
}

Session bright_session()
{
    return plain_session({{20000.0, RED, 0.1}, {65535.0, RED, 0.2}}, {4, 4});
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "distances to occupied cells are exact, far, near, and across bricks")
{
    const glm::ivec3 size(130, 60, 75);
    const std::vector<std::vector<glm::ivec3>> places = {{},
                                                         {{0, 0, 0}},
                                                         {{129, 59, 74}},
                                                         {{64, 30, 37}},
                                                         {{31, 31, 31}},
                                                         {{32, 32, 32}},
                                                         {{2, 2, 2}, {126, 50, 70}},
                                                         {{0, 59, 0}, {129, 0, 74}, {65, 0, 0}}};
    for (const std::vector<glm::ivec3>& set : places) {
        CAPTURE(set.size());
        load(dots(size, set));
        const Grid grid = grid_of(*this, bright_session());
        CHECK(grid.counts == glm::ivec3(40, 16, 24));
        check_distances(grid);
        if (set.empty())
            CHECK(std::ranges::all_of(
                grid.entries, [](uint32_t entry) { return entry >> gpu::LEAP_DISTANCE_SHIFT == gpu::LEAP_LIMIT; }));
        for (const glm::ivec3& place : set) CHECK(grid.distance(place / int(gpu::CELL_SIZE)) == 0);
        check_occupancy(volume(), bright_session(), grid);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a voxel occupies the cells whose samples it reaches, and no others")
{
    load(dots({40, 40, 40}, {{16, 17, 19}}));
    const Grid grid = grid_of(*this, bright_session());
    for_each_cell(grid.counts, [&](const glm::ivec3& cell) {
        // Half a voxel around it: x = 16 reaches the cell below, y = 17 none, z = 19 the cell above.
        const bool is_reached = (cell.x == 3 || cell.x == 4) && cell.y == 4 && (cell.z == 4 || cell.z == 5);
        CHECK((grid.distance(cell) == 0) == is_reached);
    });
}

TEST_CASE_FIXTURE(OnDevice, "without skipping every cell is occupied")
{
    load(dots({40, 33, 20}, {{5, 5, 5}}));
    Session session = bright_session();
    session.render.skip_empty_space = false;
    const Grid grid = grid_of(*this, session);
    CHECK(std::ranges::all_of(grid.entries, [](uint32_t entry) { return entry >> gpu::LEAP_DISTANCE_SHIFT == 0; }));
}

TEST_CASE_FIXTURE(OnDevice, "every cell names the brick it lies in, and no two bricks share a slot")
{
    load(noise_volume({70, 40, 100}, 61));
    const Grid grid = grid_of(*this, bright_session());
    std::vector<uint32_t> slots;
    for_each_cell(grid.counts, [&](const glm::ivec3& cell) {
        const size_t index = size_t(cell.x + grid.counts.x * (cell.y + grid.counts.y * cell.z));
        const glm::ivec3 first = cell / int(gpu::BRICK_CELLS) * int(gpu::BRICK_CELLS);
        const size_t corner = size_t(first.x + grid.counts.x * (first.y + grid.counts.y * first.z));
        CHECK((grid.entries[index] & gpu::LEAP_SLOT_MASK) == (grid.entries[corner] & gpu::LEAP_SLOT_MASK));
        if (index == corner) slots.push_back(grid.entries[index] & gpu::LEAP_SLOT_MASK);
    });
    std::ranges::sort(slots);
    CHECK(slots.size() == 3 * 2 * 4);
    CHECK(std::ranges::adjacent_find(slots) == slots.end());
    CHECK(slots.front() != gpu::NO_SLOT);
}

TEST_CASE_FIXTURE(OnDevice, "random looks of a random field occupy what they show")
{
    std::mt19937 random(62);  // seed 62
    const auto uniform = [&] { return double(random()) / 4294967296.0; };
    load(volume_of({70, 50, 45}, [&](const glm::dvec3& p) {
        return 30000.0 + 14000.0 * std::sin(0.11 * p.x) + 12000.0 * std::cos(0.13 * p.y + 0.05 * p.z) +
               900.0 * uniform();
    }));
    for (int trial = 0; trial < 40; ++trial) {
        CAPTURE(trial);
        const double lower = std::round(60000.0 * uniform());
        const double width = trial % 3 == 0 ? std::ceil(30.0 * uniform()) : (65535.0 - lower) * uniform() + 1.0;
        Session session = plain_session({{lower, RED, trial % 2 == 0 ? 0.0 : 0.1},
                                         {lower + 0.3 * width, RED, 0.2},
                                         {lower + 0.6 * width, RED, 0.0},
                                         {lower + 0.8 * width, RED, 0.0},
                                         {lower + width, RED, 0.3}},
                                        {4, 4});
        const Grid grid = grid_of(*this, session);
        check_distances(grid);
        check_occupancy(volume(), session, grid);
    }
}

namespace {

struct Refining : OnDevice {
    void refine(const Session& session)
    {
        while (std::optional<FrameGraph> graph = next_refinement(renderer().scene(), session.look()))
            renderer().executor().run(*graph);
    }
};

}  // namespace

TEST_CASE_FIXTURE(Refining, "painting patches what it can reach, and refining makes that exact")
{
    load(dots({150, 130, 140}, {{3, 3, 3}, {140, 120, 130}}));
    const Session session = bright_session();
    Session other = session;
    other.render.skip_empty_space = false;
    Annotator annotator(renderer());
    std::mt19937 random(63);  // seed 63
    const auto below = [&](int end) { return int(random() % uint32_t(end)); };
    draw(session, camera_looking("front", volume().info()));
    for (int trial = 0; trial < 25; ++trial) {
        CAPTURE(trial);
        if (trial % 5 == 4)
            annotator.undo();
        else
            annotator.paint({.brush = Brush::fill,
                             .group = uint8_t(trial % 3),
                             .radius_voxels = 1.0 + below(8),
                             .path = {{below(150), below(130), below(140)}, {below(150), below(130), below(140)}}});
        const Grid patched = grid_of(*this, session);
        const ImageF by_patch = draw(session, camera_looking("front", volume().info()));
        if (trial % 2 == 0) refine(session);  // every other time two changes precede it
        const Grid renewed = grid_of(*this, session);
        // A sample bit that was not renewed loses paint.
        CHECK(draw(other, camera_looking("front", volume().info())) == by_patch);
        const Grid fresh = grid_of(*this, session);
        if (trial % 2 == 0) CHECK(renewed.entries == fresh.entries);
        size_t wrong = 0;
        for (size_t i = 0; i < fresh.entries.size(); ++i) {
            const uint32_t distance = patched.entries[i] >> gpu::LEAP_DISTANCE_SHIFT;
            const uint32_t exact = fresh.entries[i] >> gpu::LEAP_DISTANCE_SHIFT;
            const uint32_t differing = patched.entries[i] ^ fresh.entries[i];
            wrong += distance > exact || (distance == 0) != (exact == 0) || (differing & REST) != 0;
        }
        CHECK(wrong == 0);
        check_painted(fresh, annotator.document().mask);
        refine(session);
        CHECK(!renderer().volume().refinement_is_due());
    }
}

TEST_CASE_FIXTURE(OnDevice, "a patch covers what a change can reach and no more, and costs less than all stages")
{
    load(dots({256, 256, 256}, {{3, 3, 3}, {250, 250, 250}}));
    const Session session = bright_session();
    draw(session, camera_looking("front", volume().info()));
    Annotator annotator(renderer());
    annotator.paint({.brush = Brush::fill, .group = 1, .radius_voxels = 4.0, .path = {{128.5, 128.5, 128.5}}});
    const std::optional<FrameGraph> patch = next_preparation(renderer().scene(), session.look());
    REQUIRE(patch);
    REQUIRE(patch->passes().size() > 0);
    uint64_t threads = 0;
    for (const PassData& pass : patch->passes())
        if (pass.kernel.starts_with("leap")) threads += uint64_t(pass.threads.x) * pass.threads.y * pass.threads.z;
    // The ball's bricks, two a side: once alone and once with the bricks around them.
    const uint64_t changed = 2 * gpu::BRICK_CELLS, side = changed + 2 * gpu::LEAP_LIMIT;
    CHECK(threads == changed * changed * changed + side * side * side);
}
