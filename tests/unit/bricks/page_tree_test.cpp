// Which bricks a view needs. No device.

#include "engine/bricks/page_tree.h"

#include <doctest/doctest.h>

#include "shaders/pages.h"

using namespace shvr;

namespace {

VolumeInfo cube(int64_t side)
{
    VolumeInfo info;
    info.name = "cube";
    info.size = Size3(side);
    return info;
}

bool everything(const BrickKey& /*key*/)
{
    return true;
}

PageView front(const VolumeInfo& info, uint32_t pixels, double detail)
{
    return {.camera = camera_looking("front", info), .pixels = glm::uvec2(pixels), .detail = detail};
}

/// The leaf that covers a voxel, as a ray finds it; null where the directory says that it is empty.
std::optional<uint32_t> leaf_at(const PageTree& tree, const glm::uvec3& voxel)
{
    int shift = tree.cell_shift;
    uint32_t at = gpu::grid_index(voxel >> uint32_t(shift), tree.counts);
    while (tree.entries[at] >> gpu::PAGE_LEVEL_SHIFT == gpu::PAGE_NODE) {
        --shift;
        const glm::uvec3 half = voxel >> uint32_t(shift) & 1u;
        at = (tree.entries[at] & gpu::PAGE_PAYLOAD_MASK) + half.x + 2 * half.y + 4 * half.z;
    }
    if (tree.leaf_of_entry[at] == PageTree::NO_LEAF) return std::nullopt;
    return tree.leaf_of_entry[at];
}

}  // namespace

TEST_CASE("without detail every brick of the finest level is a leaf, and is found where it lies")
{
    const VolumeInfo info = cube(100);  // 4^3 bricks, the last of them cut
    const PageTree tree = make_page_tree(info, 3, front(info, 64, 0.0), everything);
    CHECK(tree.finest_level == 0);
    CHECK(tree.leaves.size() == 64);
    CHECK((tree.counts == glm::uvec3(4)));
    for (uint32_t z = 5; z < 100; z += 30)
        for (uint32_t y = 5; y < 100; y += 30)
            for (uint32_t x = 5; x < 100; x += 30) {
                const auto leaf = leaf_at(tree, {x, y, z});
                REQUIRE(leaf);
                CHECK(tree.leaves[*leaf].key == BrickKey{0, glm::ivec3(x, y, z) / 32});
            }
    for (size_t i = 1; i < tree.leaves.size(); ++i) CHECK(tree.leaves[i - 1].depth <= tree.leaves[i].depth);
}

TEST_CASE("bricks beyond an oblique plane are no leaves, and all others are")
{
    VolumeInfo info = cube(128);  // 4^3 bricks
    info.spacing = {1.0, 2.0, 0.5};
    PageView view = front(info, 64, 0.0);
    const size_t all = make_page_tree(info, 3, view, everything).leaves.size();
    view.cut.plane_normal = glm::dvec3(1.0, 0.5, -2.0);
    view.cut.plane_point = glm::dvec3(70.0, 60.0, 50.0);
    const PageTree tree = make_page_tree(info, 3, view, everything);
    CHECK(tree.leaves.size() < all);
    for (uint32_t z = 0; z < 128; z += 8)
        for (uint32_t y = 0; y < 128; y += 8)
            for (uint32_t x = 0; x < 128; x += 8) {
                const glm::dvec3 from_plane = (glm::dvec3(x, y, z) + 0.5 - *view.cut.plane_point) * info.spacing;
                const double beyond = glm::dot(*view.cut.plane_normal, from_plane);
                if (beyond <= 0.0) CHECK(leaf_at(tree, {x, y, z}));
                if (beyond > 150.0) CHECK(!leaf_at(tree, {x, y, z}));  // more than a brick
            }
}

TEST_CASE("bricks are as coarse as pixels allow")
{
    const VolumeInfo info = cube(2048);
    for (const uint32_t pixels : {64u, 256u, 1024u}) {
        const PageTree tree = make_page_tree(info, 7, front(info, pixels, 1.0), everything);
        // The sphere around the cube, sqrt(3) * 2048 voxels across, fills the picture.
        const double voxels_per_pixel = 1.05 * std::sqrt(3.0) * 2048.0 / pixels;
        CHECK(std::ldexp(1.0, tree.finest_level) <= voxels_per_pixel);
        CHECK(std::ldexp(1.0, tree.finest_level) > voxels_per_pixel / 4.0);  // the near side is larger than the middle
        CHECK(tree.counts.x <= gpu::PAGE_GRID);
    }
}

TEST_CASE("every voxel in a close view of a huge volume has one leaf, however deep")
{
    const VolumeInfo info = cube(65536);
    PageView view = front(info, 200, 1.0);
    view.camera.target = glm::dvec3(65530.0, 65530.0, 65530.0);
    view.camera.eye = view.camera.target - glm::dvec3(0.0, 60.0, 0.0);
    const PageTree tree = make_page_tree(info, 12, view, everything);
    CHECK(tree.finest_level == 0);
    CHECK(tree.depth > 0);
    const auto leaf = leaf_at(tree, {65530, 65500, 65530});
    REQUIRE(leaf);
    CHECK(tree.leaves[*leaf].key == BrickKey{0, glm::ivec3(65530, 65500, 65530) / 32});
    CHECK(!leaf_at(tree, {10, 10, 10}));  // behind the camera
    size_t filled = 0;
    for (const uint32_t entry_leaf : tree.leaf_of_entry) filled += entry_leaf != PageTree::NO_LEAF;
    CHECK(filled >= tree.leaves.size());
}

TEST_CASE("what is cut away or shows nothing is no leaf, and rays may leap there")
{
    const VolumeInfo info = cube(256);
    PageView view = front(info, 64, 0.0);
    view.cut.upper = {256.0, 256.0, 96.0};
    const auto left_half = [](const BrickKey& key) { return (key.brick.x << key.level) < 4; };
    const PageTree tree = make_page_tree(info, 4, view, left_half);
    CHECK(tree.leaves.size() == 4 * 8 * 4);  // the brick at the cut's edge is drawn
    for (const PageTree::Leaf& leaf : tree.leaves) CHECK(leaf.key.brick.x < 4);
    // Four bricks to the nearest leaf: the last column of them is empty up to three.
    const uint32_t far = tree.entries[gpu::grid_index({7, 3, 1}, tree.counts)];
    CHECK((far >> gpu::PAGE_DISTANCE_SHIFT) == 4);
    const uint32_t near = tree.entries[gpu::grid_index({4, 3, 1}, tree.counts)];
    CHECK((near >> gpu::PAGE_DISTANCE_SHIFT) == 1);
}

TEST_CASE("a view of more leaves than there may be is taken with less detail")
{
    const VolumeInfo info = cube(1024);
    const PageTree tree = make_page_tree(info, 6, front(info, 512, 0.0), everything, 1000);
    CHECK(tree.leaves.size() <= 1000);
    CHECK(tree.finest_level > 0);
}

TEST_CASE("the entries below any brick are those of the leaves in it")
{
    const VolumeInfo info{.name = "", .size = {700, 300, 1100}, .spacing = glm::dvec3(1.0)};
    for (const double detail : {0.0, 1.0, 4.0}) {
        CAPTURE(detail);
        const PageTree tree = make_page_tree(info, 7, front(info, 200, detail), everything);
        for (int level = 0; level < 7; ++level) {
            const glm::ivec3 counts = brick_counts(size_of_level(info.size, level));
            std::vector<int> seen(tree.entries.size());
            for (int z = 0; z < counts.z; ++z)
                for (int y = 0; y < counts.y; ++y)
                    for (int x = 0; x < counts.x; ++x)
                        for_each_entry_below(tree, {level, {x, y, z}}, [&](uint32_t entry, uint32_t leaf) {
                            BrickKey above = tree.leaves.at(leaf).key;
                            REQUIRE(above.level <= level);
                            while (above.level < level) above = parent_of(above);
                            REQUIRE(above == BrickKey{level, {x, y, z}});
                            REQUIRE(tree.leaf_of_entry.at(entry) == leaf);
                            ++seen.at(entry);
                        });
            for (uint32_t entry = 0; entry < seen.size(); ++entry) {
                const uint32_t leaf = tree.leaf_of_entry[entry];
                const bool is_below = leaf != PageTree::NO_LEAF && tree.leaves[leaf].key.level <= level;
                REQUIRE(seen[entry] == int(is_below));
            }
        }
    }
}
