// The connected object, grown by the device from sets of seeds and on every level: the bits that the servo grows.

#include <random>

#include <doctest/doctest.h>

#include "engine/live/object_query.h"
#include "engine/live/relevance_host.h"
#include "engine/volume/levels/pyramid_source.h"
#include "haptics/growth.h"
#include "tests/support/gpu.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Random = std::mt19937;

/// A box of up to 70 x 18 x 18 voxels of a level: rows of up to three words.
VoxelBox random_box(const Size3& of_level, Random& random)
{
    const Size3 most = glm::min(of_level, Size3(70, 18, 18));
    const auto up_to = [&](int64_t n) { return int64_t(random() % uint32_t(n)); };
    const Size3 size(1 + up_to(most.x), 1 + up_to(most.y), 1 + up_to(most.z)), room = of_level - size + int64_t{1};
    const Size3 lower(up_to(room.x), up_to(room.y), up_to(room.z));
    return {lower, lower + size};
}

/// A box in the same level, shifted by a few voxels and of the same size or less.
VoxelBox box_near(const VoxelBox& box, const Size3& of_level, Random& random)
{
    const auto step = [&] { return int64_t(random() % 13) - 6; };
    const Size3 lower = glm::clamp(box.lower + Size3(step(), step(), step()), Size3(0), of_level - int64_t{1});
    return {lower, glm::min(lower + box.size(), of_level)};
}

void to_patch(const RelevanceBits& bits, double spacing, uint64_t sequence, RelevancePatch& patch)
{
    patch.sequence = sequence;
    patch.origin = glm::ivec3(bits.box.lower);
    patch.size = glm::ivec3(bits.box.size());
    patch.words_per_row = int32_t(bits.words_per_row);
    patch.spacing = glm::dvec3(spacing);
    patch.level = bits.level;
    patch.volume_size = glm::ivec3(1 << 20);
    std::ranges::copy(bits.words, patch.words.begin());
}

void clear_row_ends(RelevanceBits& bits)
{
    if (bits.box.size().x % 32 == 0) return;
    for (size_t i = size_t(bits.words_per_row) - 1; i < bits.words.size(); i += size_t(bits.words_per_row))
        bits.words[i] &= ~0u >> (32 - bits.box.size().x % 32);
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "bits after the ends of rows are no voxels, of what is grown in and of what it grows from")
{
    // Four rows of five voxels each; words hold ones after them.
    const VoxelBox box{Size3(0), Size3(5, 2, 2)}, beside{Size3(5, 0, 0), Size3(10, 2, 2)};
    const RelevanceBits mask{.box = box, .words_per_row = 1, .words = {0xfffffff1u, 0u, 0u, 0xffffffe0u}, .level = 0};
    const auto grown_from = [&](const RelevanceBits& seeds) {
        ObjectQuery query(renderer());
        const ObjectQuery::Growth growth{mask, seeds};
        query.ask({&growth, 1});
        return query.answer().front().words;
    };
    const std::vector<uint32_t> nothing(4, 0u);
    const RelevanceBits same{.box = box, .words_per_row = 1, .words = {0x11u, 0u, 0u, ~0u}, .level = 0};
    CHECK(grown_from(same) == std::vector<uint32_t>{0x11u, 0u, 0u, 0u});
    // A box that ends where the region begins overlaps it only with padding bits, which are no voxels.
    const VoxelBox before{Size3(0), Size3(5, 2, 2)};
    const RelevanceBits shifted{.box = beside, .words_per_row = 1, .words = {1u, 1u, 1u, 1u}, .level = 0};
    const RelevanceBits ends{
        .box = before, .words_per_row = 1, .words = std::vector<uint32_t>(4, ~0u << 5), .level = 0};
    ObjectQuery query(renderer());
    const ObjectQuery::Growth growth{shifted, ends};
    query.ask({&growth, 1});
    CHECK(query.answer().front().words == nothing);
}

TEST_CASE_FIXTURE(OnDevice, "on random fields of every level the device grows the servo's bits from sets of seeds")
{
    constexpr int BATCH = 64;
    const int batches = repeats(24, 160);
    Random random(97);
    const Size3 size(150, 90, 80);
    const auto source = with_levels(source_of(noise_volume(glm::ivec3(size), 98)), uint64_t{1} << 30);
    REQUIRE(source->levels() >= 3);
    const auto mask = std::make_unique<RelevancePatch>(), object = std::make_unique<RelevancePatch>(),
               grown = std::make_unique<RelevancePatch>();
    const auto list = std::make_unique<GrowthList>();
    size_t wrong = 0, by_level[3] = {}, sets = 0, parts = 0, fields = 0;
    for (int batch = 0; batch < batches; ++batch) {
        std::vector<RelevanceBits> masks, objects;
        for (int i = 0; i < BATCH; ++i) {
            const int level = int(random() % 3);
            const Size3 of_level = size_of_level(size, level);
            // Means of coarser levels lie closer to the middle.
            const double spread = (double(random() % 100) - 50.0) / 100.0 / double(1 << level) * 0.5;
            masks.push_back(relevance_on_host(*source, level, random_box(of_level, random), 65535.0 * (0.55 + spread)));
            // The previous object: some voxels of a box near or over the new one.
            const VoxelBox box_before =
                random() % 5 == 0 ? random_box(of_level, random) : box_near(masks.back().box, of_level, random);
            RelevanceBits before{.box = box_before, .words_per_row = 0, .words = {}, .level = level};
            const Size3 box = before.box.size();
            before.words_per_row = (box.x + 31) / 32;
            before.words.resize(size_t(before.words_per_row * box.y * box.z));
            for (uint32_t& word : before.words) word = uint32_t(random()) & uint32_t(random()) & uint32_t(random());
            if (random() % 2 == 0)
                for (uint32_t& word : before.words) word &= random() % 8 == 0 ? ~0u : 0u;
            clear_row_ends(before);
            objects.push_back(std::move(before));
        }
        std::vector<ObjectQuery::Growth> growths;
        for (size_t i = 0; i < masks.size(); ++i) growths.push_back({masks[i], objects[i]});
        ObjectQuery query(renderer());
        query.ask(growths);
        const std::vector<RelevanceBits> answers = query.answer();
        REQUIRE(answers.size() == masks.size());
        for (size_t i = 0; i < masks.size(); ++i) {
            const double spacing = double(1 << masks[i].level);
            to_patch(masks[i], spacing, 2, *mask);
            to_patch(objects[i], spacing, 1, *object);
            begin_growth(*mask, *grown, *list);
            const uint32_t seeded = seed_from_object(*object, *mask, glm::dvec3(0.0), 1e9, *grown, *list);
            grow(*mask, *grown, *list, ~0u);
            REQUIRE(answers[i].words.size() == grown->word_count());
            REQUIRE(answers[i].box == masks[i].box);
            wrong += !std::equal(answers[i].words.begin(), answers[i].words.end(), grown->words.begin());
            ++fields;
            ++by_level[masks[i].level];
            sets += seeded > 1;
            parts += seeded > 0 && answers[i].words != masks[i].words;
        }
    }
    CHECK(wrong == 0);
    CHECK(fields >= repeats<size_t>(1500, 10'000));
    for (const size_t of_level : by_level) CHECK(of_level > fields / 4);
    MESSAGE(sets, " of ", fields, " fields had seeds in several words, ", parts, " grew a part of what is relevant");
    CHECK(sets > fields / 4);
    CHECK(parts > fields / 4);
}

TEST_CASE_FIXTURE(OnDevice,
                  "where the level changes, seeds found across levels grow to the servo's bits; mixed ones are refused")
{
    Random random(99);
    const Size3 size(128, 96, 96);
    const auto source = with_levels(source_of(noise_volume(glm::ivec3(size), 100)), uint64_t{1} << 30);
    const auto mask = std::make_unique<RelevancePatch>(), object = std::make_unique<RelevancePatch>(),
               grown = std::make_unique<RelevancePatch>();
    const auto list = std::make_unique<GrowthList>();
    size_t seeded = 0;
    for (int i = 0; i < 200; ++i) {
        const int from = i % 2, to = 1 - from;
        const RelevanceBits bits = relevance_on_host(*source, to, random_box(size_of_level(size, to), random), 33000.0);
        const auto there = [&](const Size3& voxel) { return from == 0 ? voxel * int64_t{2} : voxel / int64_t{2}; };
        const Size3 of_level = size_of_level(size, from), lower = there(bits.box.lower);
        const VoxelBox same{lower, glm::min(glm::max(there(bits.box.upper), lower + int64_t{1}), of_level)};
        RelevanceBits before = relevance_on_host(*source, from, box_near(same, of_level, random), 36000.0);
        to_patch(bits, double(1 << to), 2, *mask);
        to_patch(before, double(1 << from), 1, *object);
        const glm::dvec3 middle = 0.5 * glm::dvec3(bits.box.lower + bits.box.upper) * double(1 << to);
        begin_growth(*mask, *grown, *list);
        seeded += seed_from_object(*object, *mask, middle, 40.0, *grown, *list) > 0;
        RelevanceBits seeds = bits;  // the seeds themselves, before anything grew
        std::copy_n(grown->words.begin(), seeds.words.size(), seeds.words.begin());
        grow(*mask, *grown, *list, ~0u);
        ObjectQuery query(renderer());
        const ObjectQuery::Growth growth{bits, seeds};
        query.ask({&growth, 1});
        const std::vector<RelevanceBits> answers = query.answer();
        CHECK(std::equal(answers[0].words.begin(), answers[0].words.end(), grown->words.begin()));
        const ObjectQuery::Growth mixed{bits, before};
        CHECK_THROWS_WITH_AS(query.ask({&mixed, 1}), doctest::Contains("expected the same"), Error);
    }
    CHECK(seeded > 30);
}
