// How many bricks an atlas holds along each axis, and in how many images (engine/device/device_volume.h).

#include <algorithm>
#include <array>

#include <doctest/doctest.h>

#include "engine/device/device_volume.h"
#include "shaders/bricks.h"

using namespace shvr;

namespace {

uint64_t product(const glm::uvec3& counts)
{
    return uint64_t{counts.x} * counts.y * counts.z;
}

gpu::DeviceTraits traits_of(uint32_t side, uint64_t volume_bytes, bool is_cpu = false)
{
    gpu::DeviceTraits traits{.is_cpu = is_cpu, .max_volume_bytes = volume_bytes};
    traits.limits.maxImageDimension3D = side;
    return traits;
}

constexpr uint32_t SIDES[] = {256, 2048, 16384};
constexpr uint64_t SLOTS[] = {1, 2, 7, 8, 9, 64, 100, 343, 5000, 27000, 200000};
constexpr uint64_t GIB = uint64_t{1} << 30;

}  // namespace

TEST_CASE("an atlas holds what is asked for within the device's sides, and a row more at most")
{
    for (const uint32_t side : SIDES)
        for (const bool narrow : {false, true})
            for (const uint64_t slots : SLOTS) {
                const uint64_t a_side = std::min<uint64_t>(side / gpu::BRICK_TEXELS, 255);
                if (slots > max_atlas_slots(gpu::BRICK_TEXELS, side)) {
                    CHECK_THROWS_AS(atlas_layout(slots, gpu::BRICK_TEXELS, side, narrow), Error);
                    continue;
                }
                CAPTURE(side);
                CAPTURE(slots);
                CAPTURE(narrow);
                const glm::uvec3 counts = atlas_layout(slots, gpu::BRICK_TEXELS, side, narrow);
                CHECK(product(counts) >= slots);
                for (int axis = 0; axis < 3; ++axis) CHECK(counts[axis] <= a_side);
                CHECK(product(counts) - slots < counts.x + counts.x * counts.y);
            }
    CHECK(max_atlas_slots(gpu::BRICK_TEXELS, 256) == 343);
    CHECK(max_atlas_slots(gpu::BRICK_TEXELS, 16384) == 255 * 255 * 255);
}

TEST_CASE("an atlas is a cube on a GPU, and of short rows where images are linear")
{
    const glm::uvec3 cube = atlas_layout(27000, gpu::BRICK_TEXELS, 2048, false);
    CHECK(cube == glm::uvec3(30));
    const glm::uvec3 narrow = atlas_layout(27000, gpu::BRICK_TEXELS, 4096, true);
    CHECK(narrow.x == 8);
    // Longer rows where the two other axes do not suffice.
    CHECK(atlas_layout(60 * 60 * 20, gpu::BRICK_TEXELS, 2048, true).x == 20);
}

TEST_CASE("bricks are in as few images as the device's limits allow, all of one size, and in five nowhere")
{
    for (const bool is_cpu : {false, true})
        for (const uint32_t side : SIDES)
            for (const uint64_t bytes : {uint64_t{24} << 20, 2 * GIB}) {
                const gpu::DeviceTraits traits = traits_of(side, bytes, is_cpu);
                const uint64_t most =
                    std::min(bytes / BrickTexels::CODE_BYTES, max_atlas_slots(gpu::BRICK_TEXELS, side));
                for (const uint64_t slots : {uint64_t{1}, most / 2, most - most / 9, most + most / 2,
                                             2 * most + most / 3, 3 * most + most / 2, 4 * most + 1}) {
                    CAPTURE(is_cpu);
                    CAPTURE(side);
                    CAPTURE(slots);
                    const std::optional<StackedLayout> layout = stacked_layout(slots, AtlasCodes::exact16, traits);
                    if (!layout) {
                        CHECK(slots > most / 9 * 8);  // rounding up may ask for one image more
                        continue;
                    }
                    CHECK(layout->count() >= slots);
                    CHECK(layout->images <= gpu::MAX_ATLASES);
                    CHECK(product(layout->slots) <= most);
                    CHECK(product(layout->slots) * BrickTexels::CODE_BYTES <= bytes);
                    CHECK(layout->all().z <= 255);
                    CHECK(glm::all(glm::lessThanEqual(layout->slots * gpu::BRICK_TEXELS, glm::uvec3(side))));
                    CHECK(layout->images >= (slots + most - 1) / most);
                    if (slots <= most / 2) CHECK(layout->images == 1);
                }
                CHECK(!stacked_layout(4 * most + 1, AtlasCodes::exact16, traits));
            }
    CHECK(!stacked_layout(0, AtlasCodes::exact16, traits_of(2048, GIB)));
    CHECK(!stacked_layout(1, AtlasCodes::exact16, traits_of(16, GIB)));
}

TEST_CASE("a buffer holds bricks that would need several images, and images those that no buffer holds")
{
    gpu::DeviceTraits traits = traits_of(2048, uint64_t{24} << 20, true);
    traits.max_allocation_bytes = traits.max_buffer_bytes = GIB;
    const auto layout_of = [&](uint64_t slots, AtlasCodes codes) {
        return stacked_layout(slots, codes, traits).value();
    };
    CHECK(!layout_of(600, AtlasCodes::exact8).by_address);
    traits.reads_by_address = true;
    for (const AtlasCodes codes : {AtlasCodes::exact8, AtlasCodes::exact16}) {
        const StackedLayout layout = layout_of(600, codes);
        CHECK(layout.by_address);
        CHECK(layout.images == 1);
        CHECK(layout.count() >= 600);
    }
    CHECK(!layout_of(600, AtlasCodes::filtered).by_address);  // a sampler reads them
    traits.max_allocation_bytes = uint64_t{24} << 20;
    CHECK(!layout_of(600, AtlasCodes::exact8).by_address);
    CHECK(layout_of(600, AtlasCodes::exact8).images > 1);
    traits.max_allocation_bytes = traits.max_buffer_bytes = 64 * GIB;
    CHECK(is_by_address(traits, AtlasCodes::exact8, 8 * GIB));
    CHECK(!is_by_address(traits, AtlasCodes::exact8, 8 * GIB + 4));  // a kernel's index of a word has a sign
}

TEST_CASE("the slots of a layout are each another address, none of which has more than a byte an axis")
{
    const glm::uvec3 counts(7, 7, 4 * 7);
    std::vector<uint32_t> seen;
    for (uint32_t index = 0; index < product(counts); ++index) {
        seen.push_back(slot_at(index, counts));
        CHECK(glm::all(glm::lessThan(gpu::unpack_slot(seen.back()), counts)));
    }
    std::ranges::sort(seen);
    CHECK(std::ranges::adjacent_find(seen) == seen.end());
}
