// Relevant voxels, which can be felt: the device's compute pass and the host give the same bits, and growing on the
// device gives the bits that the servo grows in its tick.

#include <map>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/work/work_offsets.h"
#include "engine/live/relevance_host.h"
#include "engine/volume/levels/pyramid_source.h"
#include "haptics/growth.h"
#include "tests/support/gpu.h"
#include "tests/support/haptic_scenes.h"
#include "tests/support/nap.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Source = std::shared_ptr<const VolumeSource>;

/// Every third brick has offsets, both up and down, also at the volume's borders.
DensityField random_offsets(const Size3& size, VoxelType type, uint32_t seed)
{
    std::mt19937 random(seed);
    DensityField field(size, type);
    const Size3 counts = field.brick_counts();
    const int32_t most = type == VoxelType::uint8 ? 300 : 70'000;
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; brick += 3) {
        OffsetBrick offsets{};
        for (uint32_t& bits : offsets)
            if (random() % 2 == 0) bits = offset_bits(type, double(int32_t(random() % uint32_t(2 * most)) - most));
        field.put(brick, offsets);
    }
    return field;
}

RelevanceBits on_device(Renderer& renderer, const VoxelBox& box, double threshold)
{
    Relevance relevance(renderer);
    for (int i = 0; !relevance.is_asking(); ++i) {
        REQUIRE(i < 100);
        relevance.ask(box, threshold, 1);
        if (!relevance.is_asking()) renderer.scene().advance(true);  // its bricks were being loaded
    }
    std::optional<RelevanceBits> bits;
    for (int turn = 0; !(bits = relevance.take()); ++turn) nap(turn);
    return *bits;
}

/// Compares boxes at the borders and in the middle, for thresholds at both ends of the range and between. Everyday runs
/// take an eighth of these pairs, which `part` chooses: of eight parts each pair is in one.
void check_equal(Renderer& renderer, const VolumeSource& source, double highest, size_t part)
{
    const Size3 size = source.info().size;
    const glm::dvec3 far = glm::dvec3(size);
    for (const int64_t side : {Relevance::SIDE, Relevance::LARGE_SIDE}) {
        for (const glm::dvec3& at : {glm::dvec3(0.0), far, 0.5 * far, glm::dvec3(far.x, 0.0, 0.3 * far.z)}) {
            const VoxelBox box = relevance_cube(at, size, side);
            size_t pair = part++;
            for (const double share : {-0.1, 0.0, 0.25, 0.5, 0.501, 1.0, 1.1}) {
                if (const bool is_everyday = pair++ % 8 == 0; !is_everyday && !is_slow()) continue;
                const double threshold = share * highest;
                const RelevanceBits device = on_device(renderer, box, threshold);
                const RelevanceBits host = relevance_on_host(source, 0, box, threshold);
                CAPTURE(side);
                CAPTURE(share);
                CHECK(device.box == host.box);
                CHECK(device.words_per_row == host.words_per_row);
                CHECK(device.words == host.words);
            }
        }
    }
}

uint32_t bit_of(const RelevanceBits& bits, const Size3& at)
{
    const Size3 size = bits.box.size();
    return bits.words[size_t(at.x / 32 + bits.words_per_row * (at.y + size.y * at.z))] >> (at.x % 32) & 1u;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "the host's relevance is the device's, bit for bit: types, offsets, paging, borders")
{
    size_t part = 0;
    for (const VoxelType type : {VoxelType::uint8, VoxelType::uint16}) {
        const double highest = type == VoxelType::uint8 ? 255.0 : 65535.0;
        TestVolume noise = noise_volume({150, 131, 140}, 91);
        noise.type = type;
        noise.maximum = highest;
        if (type == VoxelType::uint8)
            for (double& voxel : noise.voxels) voxel = std::floor(voxel / 257.0);
        const Source source = source_of(noise);
        const DensityField offsets = random_offsets(source->info().size, type, 92);
        for (const Paging paging : {Paging::never, Paging::always}) {
            CAPTURE(int(type));
            CAPTURE(paging == Paging::always);
            renderer().load(
                source, {.minimum = 0.0, .maximum = highest},
                {.sampling = type == VoxelType::uint8 ? Sampling::automatic : Sampling::exact, .paging = paging});
            check_equal(renderer(), *source, highest, part++);
            renderer().scene().show(Document{.mask = Mask(source->info().size), .trace = {}, .density = offsets});
            check_equal(renderer(), *with_offsets(source, offsets), highest, part++);
        }
    }
}

TEST_CASE("a ball's cube grows with it, then becomes coarser, and always holds the ball")
{
    const Source source = with_levels(source_of(constant_volume({300, 200, 400}, 1.0)), uint64_t{1} << 30);
    std::mt19937 random(93);
    std::map<std::pair<int, int64_t>, int> kinds;
    for (int i = 0; i < 2000; ++i) {
        const auto share = [&] { return double(random()) / 4294967296.0; };
        const glm::dvec3 at = glm::dvec3(share(), share(), share()) * glm::dvec3(300, 200, 400);
        const double radius = 1.0 + 95.0 * share();
        const RelevancePlace place = relevance_place(*source, {.point = at, .radius = radius});
        CHECK(place.covers(at, radius));
        CHECK(!place.covers(at, 1000.0));
        ++kinds[{place.level, place.box.size().x}];
    }
    CHECK(kinds.contains({0, 64}));
    CHECK(kinds.contains({0, 128}));
    CHECK(kinds.contains({1, 128}));
    CHECK(kinds.size() == 3);
}

TEST_CASE("limited to groups only what is painted so is left, on any level")
{
    const Size3 size(50, 40, 36);
    const Source source = with_levels(source_of(noise_volume(size, 94)), uint64_t{1} << 30);
    std::mt19937 random(95);
    Mask mask(size);
    const Size3 counts = mask.brick_counts();
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; ++brick) {
        MaskBrickChange change{.brick = brick, .runs = {}};
        const VoxelBox box = mask.box_of(brick);
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                    const size_t at = index_in_brick({x, y, z});
                    append_run(change.runs, at, at, uint8_t{0}, uint8_t(random() % 4));
                }
        mask.apply(change, Direction::forwards);
    }
    std::bitset<256> groups;
    groups.set(2).set(3);
    for (const int level : {0, 1}) {
        const Size3 of_level = size_of_level(size, level);
        const VoxelBox box{Size3(3, 2, 1) / int64_t(level + 1), of_level};
        const RelevanceBits all = relevance_on_host(*source, level, box, 20000.0);
        RelevanceBits limited = all;
        limit_to_groups(mask, groups, limited);
        size_t wrong = 0, left = 0;
        const Size3 boxed = box.size();
        for (int64_t z = 0; z < boxed.z; ++z)
            for (int64_t y = 0; y < boxed.y; ++y)
                for (int64_t x = 0; x < boxed.x; ++x) {
                    const Size3 lower_voxel = (box.lower + Size3(x, y, z)) * int64_t(1 << level);
                    int felt = 0, others = 0;
                    for (int i = 0; i < 1 << 3 * level; ++i) {
                        const Size3 voxel = lower_voxel + Size3(i & 1, i >> 1 & 1, i >> 2);
                        if (glm::any(glm::greaterThanEqual(voxel, size))) continue;
                        const uint8_t group = mask.at(voxel);
                        felt += group >= 2;
                        others += group == 1;
                    }
                    const bool expected = bit_of(all, {x, y, z}) && felt > 0 && felt >= others;
                    wrong += expected != bool(bit_of(limited, {x, y, z}));
                    left += expected;
                }
        CHECK(wrong == 0);
        CHECK(left > 1000);
    }
}

TEST_CASE("what is painted entirely feels the same limited to its group or not, on every level, also where it is thin")
{
    // Threads of one voxel, brighter than the threshold by far: most coarse voxels that they make relevant hold one or
    // two painted voxels, none of them in the middle. A neighbour in another group is not felt next to them.
    const Size3 size(96, 80, 72);
    TestVolume threads = constant_volume(glm::ivec3(size), 0.0);
    Mask mask(size);
    std::map<int64_t, std::vector<std::pair<size_t, uint8_t>>> painted;
    const Size3 counts = mask.brick_counts();
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) {
                const bool is_thread = y % 16 == 0 && z % 16 == 3, is_other = x < 16 && y % 16 == 8 && z % 16 == 8;
                if (!is_thread && !is_other) continue;
                threads.voxels[size_t(index_of({x, y, z}, size))] = 60000.0;
                painted[index_of(Size3(x, y, z) / int64_t{BRICK_SIDE}, counts)].emplace_back(
                    index_in_brick({x, y, z}), is_thread ? uint8_t{3} : uint8_t{1});
            }
    for (auto& [brick, voxels] : painted) {
        MaskBrickChange change{.brick = brick, .runs = {}};
        std::ranges::sort(voxels);
        for (const auto& [at, group] : voxels) append_run(change.runs, at, at, uint8_t{0}, group);
        mask.apply(change, Direction::forwards);
    }
    const Source source = with_levels(source_of(threads), uint64_t{1} << 30);
    for (const int level : {0, 1, 2}) {
        CAPTURE(level);
        const VoxelBox box{Size3(0), size_of_level(size, level)};
        const double threshold = 0.9 * 60000.0 / double(int64_t{1} << 2 * level);
        const RelevanceBits all = relevance_on_host(*source, level, box, threshold);
        RelevanceBits both = all, one = all;
        limit_to_groups(mask, std::bitset<256>().set(1).set(3), both);
        CHECK(both.words == all.words);
        limit_to_groups(mask, std::bitset<256>().set(3), one);
        const auto at_level = [&](const Size3& voxel) { return voxel / int64_t(1 << level); };
        CHECK(bit_of(all, at_level({40, 16, 19})));
        CHECK(bit_of(one, at_level({40, 16, 19})));
        CHECK(bit_of(all, at_level({8, 24, 24})));
        CHECK(!bit_of(one, at_level({8, 24, 24})));
    }
}

TEST_CASE_FIXTURE(OnDevice, "on random fields the device grows the bits that the servo grows in its tick")
{
    // Fields of up to 14 voxels a side stand in cells of 16: 512 of them in each volume.
    constexpr int32_t CELL = 16, ACROSS = 8;
    const int volumes = repeats(3, 20);
    std::mt19937 random(96);
    const auto patch = std::make_unique<RelevancePatch>(), grown = std::make_unique<RelevancePatch>();
    const auto list = std::make_unique<GrowthList>();
    size_t fields = 0, wrong = 0, grown_fields = 0;
    for (int v = 0; v < volumes; ++v) {
        const double threshold = 65536.0 * (0.3 + 0.5 * double(random() % 100) / 100.0);
        load(noise_volume(glm::ivec3(CELL * ACROSS), uint32_t(random())));
        std::vector<RegionAt> regions;
        for (int32_t cell = 0; cell < ACROSS * ACROSS * ACROSS; ++cell) {
            const Size3 lower = Size3(cell % ACROSS, cell / ACROSS % ACROSS, cell / ACROSS / ACROSS) * int64_t{CELL};
            const auto side = [&] { return int64_t(1 + random() % 14); };
            BrushRegion region;
            region.box = {lower, lower + Size3(side(), side(), side())};
            const Size3 size = region.box.size();
            region.rows.assign(size_t(size.y * size.z), {0, int32_t(size.x)});
            const Size3 seed(int64_t(random()) % size.x, int64_t(random()) % size.y, int64_t(random()) % size.z);
            regions.push_back({std::move(region), glm::dvec3(lower + seed) + 0.5});
        }
        for (size_t first = 0; first < regions.size(); first += 64) {
            RegionQuery query(renderer());
            const PaintOp flood{.brush = Brush::flood, .threshold = threshold, .connectivity = 6, .path = {}};
            REQUIRE(query.ask(flood, {regions.begin() + int64_t(first), regions.begin() + int64_t(first + 64)},
                              RegionQuery::Wait::for_bricks));
            for (const RegionAnswer& answer : query.answer()) {
                const Size3 lower = answer.region.box.lower;
                const auto at = [&](const glm::dvec3& middle) {
                    const glm::ivec3 voxel(glm::floor(middle));
                    return volume().voxels[size_t(voxel.x + CELL * ACROSS * (voxel.y + CELL * ACROSS * voxel.z))];
                };
                fill_patch(*patch, glm::ivec3(lower), glm::ivec3(answer.region.box.size()), glm::dvec3(1.0),
                           [&](const glm::dvec3& middle) { return at(middle) >= threshold; });
                begin_growth(*patch, *grown, *list);
                // A ball of a tenth of a voxel: the seed and no other.
                seed_nearest(*patch, answer.centre_voxel, 0.1, *grown, *list);
                grow(*patch, *grown, *list, ~0u);
                REQUIRE(answer.words.size() == grown->word_count());
                wrong += !std::equal(answer.words.begin(), answer.words.end(), grown->words.begin());
                grown_fields += answer.words != std::vector<uint32_t>(answer.words.size(), 0u);
                ++fields;
            }
        }
    }
    CHECK(fields == size_t(volumes) * ACROSS * ACROSS * ACROSS);
    CHECK(wrong == 0);
    CHECK(grown_fields > fields / 4);
}
