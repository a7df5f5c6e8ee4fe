// The sample bits, read back from the device, against their definition by brute force, and after edits against
// rebuilt ones.

#include <algorithm>
#include <cstring>
#include <random>

#include <doctest/doctest.h>

#include "engine/device/resident_volume.h"
#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

struct Bits {
    glm::ivec3 counts{0};          ///< of cells
    std::vector<uint32_t> texels;  ///< two per cell, one above the other

    /// The bit of the samples between the voxel and the previous one along each axis.
    bool at(const glm::ivec3& voxel) const
    {
        const glm::ivec3 cell = voxel / 4, in = voxel % 4;
        const size_t texel = size_t(cell.x + counts.x * (cell.y + counts.y * (2 * cell.z + in.z / 2)));
        return (texels[texel] >> (in.x + 4 * in.y + 16 * (in.z % 2)) & 1u) != 0;
    }
};

struct WithBits : OnDevice {
    /// After a picture, which prepares them.
    Bits read(const Session& session)
    {
        draw(session, camera_looking("front", volume().info()));
        FrameGraph graph;
        const VolumeBinding binding = dynamic_cast<ResidentVolume&>(renderer().volume()).import(graph);
        REQUIRE(binding.sample_bits);
        const uint32_t back = graph.read_back(*binding.sample_bits);
        const gpu::FrameResult result = renderer().executor().run(graph);
        Bits bits{.counts = glm::ivec3(binding.cell_counts)};
        bits.texels.resize(result.read_backs[back].size() / sizeof(uint32_t));
        std::memcpy(bits.texels.data(), result.read_backs[back].data(), result.read_backs[back].size());
        return bits;
    }
    void refine(const Session& session)
    {
        while (std::optional<FrameGraph> graph = next_refinement(renderer().scene(), session.look()))
            renderer().executor().run(*graph);
    }
};

template <class Visit>
void for_each(const glm::ivec3& size, const Visit& visit)
{
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) visit(glm::ivec3(x, y, z));
}

/// The least and the greatest of the eight codes that samples below a voxel lie between; the first voxel repeats.
glm::dvec2 range_below(const TestVolume& volume, const glm::ivec3& voxel)
{
    glm::dvec2 range(65535.0, 0.0);
    for_each(glm::ivec3(2), [&](const glm::ivec3& before) {
        const glm::ivec3 at = glm::max(voxel - before, 0);
        const double code = volume.voxels[size_t(at.x + volume.size.x * (at.y + volume.size.y * at.z))];
        range = {std::min(range.x, code), std::max(range.y, code)};
    });
    return range;
}

}  // namespace

TEST_CASE_FIXTURE(WithBits,
                  "a sample whose eight voxels reach what is seen has its bit, and those far from it have none")
{
    std::mt19937 random(81);  // seed 81
    load(noise_volume({45, 38, 51}, 82));
    const double slack = 200.0;  // codes: the guard of places in whole parts, and a table's entry
    for (int trial = 0; trial < 12; ++trial) {
        CAPTURE(trial);
        // Most of noise lies in the middle of eight voxels' range: only its ends leave bits that are not set.
        const bool at_the_top = trial % 2 == 0;
        const double width = 500.0 + double(random() % 12000);
        const double lower = at_the_top ? 65535.0 - width : 0.0, upper = lower + width;
        const ControlPoint faint{at_the_top ? lower : upper, RED, 0.0}, seen{at_the_top ? upper : lower, RED, 0.2};
        const Bits bits = read(plain_session(at_the_top ? std::vector{faint, seen} : std::vector{seen, faint}, {4, 4}));
        size_t lost = 0, idle = 0, set = 0;
        for_each(volume().size, [&](const glm::ivec3& voxel) {
            const glm::dvec2 range = range_below(volume(), voxel);
            const bool is_seen = range.y > lower && range.x < upper;
            const bool is_near = range.y >= lower - slack && range.x <= upper + slack;
            lost += is_seen && !bits.at(voxel);
            idle += !is_near && bits.at(voxel);
            set += bits.at(voxel);
        });
        CHECK(lost == 0);
        CHECK(idle == 0);
        CHECK(set > 0);
        CHECK(set < size_t(volume().size.x) * size_t(volume().size.y) * size_t(volume().size.z));
    }
}

TEST_CASE_FIXTURE(WithBits, "after paint and density edits they are those made anew")
{
    // All voxels lie a few codes below visibility, within the guard: all bits of a cell next to a visible one are set.
    const double seen_from = 20000.0;
    load(constant_volume({70, 62, 58}, seen_from - 4.0));
    const Session session = plain_session({{seen_from, RED, 0.1}, {65535.0, RED, 0.2}}, {4, 4});
    Session other = session;
    other.render.skip_empty_space = false;
    Annotator annotator(renderer());
    std::mt19937 random(83);  // seed 83
    const auto below = [&](int end) { return double(random() % uint32_t(end)); };
    const auto set_in = [](const Bits& bits) {
        return std::ranges::count_if(bits.texels, [](uint32_t texel) { return texel != 0; });
    };
    CHECK(set_in(read(session)) == 0);
    int64_t most = 0;
    for (int trial = 0; trial < 24; ++trial) {
        CAPTURE(trial);
        if (trial % 4 == 3) {
            annotator.undo();
        } else {
            PaintOp op{.brush = Brush::fill,
                       .group = uint8_t(trial % 3),
                       .radius_voxels = 1.0 + below(6),
                       .path = {{below(70), below(62), below(58)}}};
            if (trial % 2 == 0) {
                op.group = 1;
                op.density = DensityBrush{3000.0, Falloff::flat};
                op.paints_group = false;
            }
            annotator.paint(op);
        }
        const Bits patched = read(session);
        refine(session);
        const Bits refined = read(session);
        draw(other, camera_looking("front", volume().info()));
        const Bits anew = read(session);
        size_t lost = 0;
        for (size_t i = 0; i < anew.texels.size(); ++i) lost += (anew.texels[i] & ~patched.texels[i]) != 0;
        CHECK(lost == 0);
        CHECK(refined.texels == anew.texels);
        most = std::max(most, int64_t(set_in(anew)));
    }
    CHECK(most > 0);
    while (annotator.undo()) {
    }
    static_cast<void>(read(session));
    refine(session);
    CHECK(set_in(read(session)) == 0);
}
