#include "haptics/growth.h"

#include <cmath>
#include <deque>
#include <memory>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

size_t index_of(const RelevancePatch& patch, const glm::ivec3& v)
{
    return size_t(v.x) + size_t(patch.size.x) * (size_t(v.y) + size_t(patch.size.y) * size_t(v.z));
}

bool holds(const RelevancePatch& patch, const glm::ivec3& v)
{
    return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, patch.size)) &&
           is_set(patch, v.x, v.y, v.z);
}

/// The plain way: a queue of voxels.
std::vector<bool> grow_slowly(const RelevancePatch& mask, const std::vector<glm::ivec3>& seeds)
{
    std::vector<bool> grown(size_t(mask.size.x) * size_t(mask.size.y) * size_t(mask.size.z));
    std::deque<glm::ivec3> queue;
    const auto add = [&](const glm::ivec3& v) {
        if (!holds(mask, v) || grown[index_of(mask, v)]) return;
        grown[index_of(mask, v)] = true;
        queue.push_back(v);
    };
    for (const glm::ivec3& seed : seeds) add(seed);
    while (!queue.empty()) {
        const glm::ivec3 v = queue.front();
        queue.pop_front();
        for (int axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                glm::ivec3 next = v;
                next[axis] += step;
                add(next);
            }
    }
    return grown;
}

size_t differences(const RelevancePatch& grown, const std::vector<bool>& truth)
{
    size_t wrong = 0;
    for (int z = 0; z < grown.size.z; ++z)
        for (int y = 0; y < grown.size.y; ++y)
            for (int x = 0; x < 32 * grown.words_per_row; ++x) {
                const bool expected = x < grown.size.x && truth[index_of(grown, {x, y, z})];
                wrong += is_set(grown, x, y, z) != expected;
            }
    return wrong;
}

struct Field {
    std::unique_ptr<RelevancePatch> mask = std::make_unique<RelevancePatch>();
    std::unique_ptr<RelevancePatch> grown = std::make_unique<RelevancePatch>();
    std::unique_ptr<RelevancePatch> object = std::make_unique<RelevancePatch>();
    std::unique_ptr<GrowthList> list = std::make_unique<GrowthList>();
};

/// Noise of a random density, as wide as words and not.
void fill_randomly(RelevancePatch& patch, const glm::ivec3& origin, const glm::ivec3& size, std::mt19937& random)
{
    const uint32_t percent = 5 + uint32_t(random()) % 90;
    fill_patch(patch, origin, size, glm::dvec3(1), [&](const glm::dvec3&) { return random() % 100 < percent; });
    // Bits beyond a row's voxels are no voxels, whatever the device left there.
    if (size.x % 32 != 0)
        for (size_t i = size_t(patch.words_per_row) - 1; i < patch.word_count(); i += size_t(patch.words_per_row))
            patch.words[i] |= ~0u << (size.x % 32);
}

glm::ivec3 random_size(std::mt19937& random, int most)
{
    const auto side = [&] { return 1 + int(random() % uint32_t(most)); };
    return {random() % 4 == 0 ? 64 : side() * 3, side(), side()};
}

}  // namespace

TEST_CASE("on 10,000 random fields growing from a carried object gives the bits of a plain search")
{
    std::mt19937 random(41);
    Field field;
    size_t wrong = 0, grown_fields = 0;
    for (int i = 0; i < 10'000; ++i) {
        const glm::ivec3 origin(int(random() % 40) - 20, int(random() % 8) - 4, int(random() % 8) - 4);
        fill_randomly(*field.mask, origin, random_size(random, 12), random);
        // The previous object: some voxels of another box, which may overlap.
        const glm::ivec3 before = random_size(random, 12);
        fill_patch(*field.object, {0, 0, 0}, before, glm::dvec3(1),
                   [&](const glm::dvec3&) { return random() % 20 == 0; });
        std::vector<glm::ivec3> seeds;
        for (int z = 0; z < before.z; ++z)
            for (int y = 0; y < before.y; ++y)
                for (int x = 0; x < before.x; ++x)
                    if (is_set(*field.object, x, y, z)) seeds.push_back(glm::ivec3(x, y, z) - origin);
        begin_growth(*field.mask, *field.grown, *field.list);
        seed_from_object(*field.object, *field.mask, glm::dvec3(0), 1.0, *field.grown, *field.list);
        while (field.list->count > 0) grow(*field.mask, *field.grown, *field.list, 7);  // in pieces
        const std::vector<bool> truth = grow_slowly(*field.mask, seeds);
        wrong += differences(*field.grown, truth);
        for (const bool bit : truth) {
            if (!bit) continue;
            ++grown_fields;
            break;
        }
    }
    CHECK(wrong == 0);
    CHECK(grown_fields > 3000);
}

TEST_CASE("cubes of 128 voxels, solid and noisy, grow to the bits of a plain search")
{
    std::mt19937 random(42);
    Field field;
    for (const uint32_t percent : {100u, 35u, 60u}) {
        fill_patch(*field.mask, {5, 6, 7}, glm::ivec3(128), glm::dvec3(0.5),
                   [&](const glm::dvec3&) { return random() % 100 < percent; });
        const glm::dvec3 centre = (glm::dvec3(5, 6, 7) + 64.0) * 0.5;
        begin_growth(*field.mask, *field.grown, *field.list);
        REQUIRE(seed_nearest(*field.mask, centre, 4.0, *field.grown, *field.list));
        const auto seeds = [&] {
            std::vector<glm::ivec3> all;
            for (int z = 60; z < 68; ++z)
                for (int y = 60; y < 68; ++y)
                    for (int x = 60; x < 68; ++x)
                        if (is_set(*field.grown, x, y, z)) all.emplace_back(x, y, z);
            return all;
        }();
        CHECK(!seeds.empty());
        grow(*field.mask, *field.grown, *field.list, ~0u);
        CHECK(differences(*field.grown, grow_slowly(*field.mask, seeds)) == 0);
    }
}

TEST_CASE("an object is carried to a coarser level and back")
{
    Field field;
    const Rod rod{.point = {16.0, 16.0, 16.0}, .radius = 2.5}, other{.point = {16.0, 24.0, 16.0}, .radius = 2.5};
    const auto both = [&](const glm::dvec3& p) { return rod.holds(p) || other.holds(p); };
    fill_patch(*field.object, {0, 0, 0}, {32, 32, 32}, glm::dvec3(1),
               [&](const glm::dvec3& p) { return rod.holds(p); });
    fill_patch(*field.mask, {0, 0, 0}, {16, 16, 16}, glm::dvec3(2), both);
    begin_growth(*field.mask, *field.grown, *field.list);
    CHECK(seed_from_object(*field.object, *field.mask, glm::dvec3(16), 6.0, *field.grown, *field.list) > 0);
    grow(*field.mask, *field.grown, *field.list, ~0u);
    CHECK(is_set(*field.grown, 0, 8, 8));
    CHECK(!is_set(*field.grown, 8, 12, 8));

    std::swap(field.object, field.grown);
    fill_patch(*field.mask, {0, 0, 0}, {32, 32, 32}, glm::dvec3(1), both);
    begin_growth(*field.mask, *field.grown, *field.list);
    CHECK(seed_from_object(*field.object, *field.mask, glm::dvec3(16), 6.0, *field.grown, *field.list) > 0);
    grow(*field.mask, *field.grown, *field.list, ~0u);
    CHECK(is_set(*field.grown, 31, 16, 16));
    CHECK(!is_set(*field.grown, 16, 24, 16));
}

TEST_CASE("growing that takes several ticks keeps the former object in force, then replaces it whole")
{
    const auto memory = std::make_unique<GrowthMemory>();
    const auto patch = std::make_unique<RelevancePatch>();
    const glm::dvec3 centre(64);
    std::mt19937 random(43);
    const auto make = [&](const glm::ivec3& origin) {
        fill_patch(*patch, origin, glm::ivec3(128), glm::dvec3(1),
                   [&](const glm::dvec3&) { return random() % 5 != 0; });
    };
    make({0, 0, 0});
    const auto tick = [&](uint64_t now_ns) -> const RelevancePatch& {
        const RelevancePatch& object = advance_object(*patch, centre, 10.0, *memory);
        keep_contact(*patch, centre, 10.0, object.sequence != 0, now_ns, *memory);
        return object;
    };
    int ticks = 0;
    while (tick(1).sequence == 0) REQUIRE(++ticks < 200);
    CHECK(ticks > 2);
    CHECK(memory->contacts == 1);
    const uint64_t first = memory->object().sequence;
    make({10, 0, 0});
    ticks = 0;
    // New patches that come meanwhile do not disturb it.
    while (tick(1).sequence == first) {
        CHECK(memory->object().origin.x == 0);
        ++patch->sequence;
        REQUIRE(++ticks < 200);
    }
    CHECK(memory->object().origin.x == 10);
    CHECK(memory->contacts == 1);
}

TEST_CASE("off the object for a moment nothing else is touched; after that the voxel nearest to the probe is")
{
    const auto memory = std::make_unique<GrowthMemory>();
    const auto patch = std::make_unique<RelevancePatch>();
    const Rod rod{.point = {32.0, 20.0, 32.0}, .radius = 3.0}, other{.point = {32.0, 44.0, 32.0}, .radius = 3.0};
    fill_patch(*patch, {0, 0, 0}, {64, 64, 64}, glm::dvec3(1),
               [&](const glm::dvec3& p) { return rod.holds(p) || other.holds(p); });
    const auto tick = [&](const glm::dvec3& centre, uint64_t now_ns) {
        const RelevancePatch& object = advance_object(*patch, centre, 6.0, *memory);
        const bool in_contact = object.sequence != 0 && find_proxy(object, centre, 6.0, ProxyLaw::potential).in_contact;
        keep_contact(*patch, centre, 6.0, in_contact, now_ns, *memory);
        return in_contact;
    };
    tick({32, 18, 32}, 1'000'000);
    CHECK(tick({32, 18, 32}, 2'000'000));
    CHECK(memory->contacts == 1);
    CHECK(is_set(memory->object(), 5, 20, 32));
    CHECK(!is_set(memory->object(), 5, 44, 32));
    // A jump to the other rod: nothing for RECONTACT_NS, then the other.
    uint64_t now_ns = 3'000'000;
    for (; now_ns < 3'000'000 + RECONTACT_NS; now_ns += 1'000'000) REQUIRE(!tick({32, 44, 32}, now_ns));
    for (int i = 0; i < 3; ++i, now_ns += 1'000'000) tick({32, 44, 32}, now_ns);
    CHECK(tick({32, 44, 32}, now_ns));
    CHECK(memory->contacts == 2);
    CHECK(is_set(memory->object(), 5, 44, 32));
    CHECK(!is_set(memory->object(), 5, 20, 32));
}

TEST_CASE("a new region keeps every part of the object that lies in it, though another object is nearer to the probe")
{
    // A bow whose middle lies outside the second region, which so holds its two ends apart; a rod between the ends.
    const auto memory = std::make_unique<GrowthMemory>();
    const auto patch = std::make_unique<RelevancePatch>();
    const Rod one{.point = {32.0, 20.0, 32.0}, .radius = 2.0}, two{.point = {32.0, 40.0, 32.0}, .radius = 2.0},
        between{.point = {32.0, 30.0, 32.0}, .radius = 2.0};
    const auto is_relevant = [&](const glm::dvec3& p) {
        const bool joins = p.x < 4.0 && p.y > 18.0 && p.y < 42.0 && std::abs(p.z - 32.0) < 2.0;
        return one.holds(p) || two.holds(p) || joins || (p.x > 8.0 && between.holds(p));
    };
    const auto tick = [&](const glm::dvec3& centre) -> const RelevancePatch& {
        const RelevancePatch& object = advance_object(*patch, centre, 6.0, *memory);
        keep_contact(*patch, centre, 6.0, object.sequence != 0, 1, *memory);
        return object;
    };
    fill_patch(*patch, {0, 0, 0}, glm::ivec3(64), glm::dvec3(1), is_relevant);
    const glm::dvec3 at_one(40.0, 21.0, 32.0), at_between(40.0, 29.0, 32.0);
    tick(at_one);
    REQUIRE(tick(at_one).sequence == patch->sequence);
    REQUIRE(is_set(memory->object(), 40, 40, 32));
    REQUIRE(!is_set(memory->object(), 40, 30, 32));
    fill_patch(*patch, {16, 0, 0}, glm::ivec3(64), glm::dvec3(1), is_relevant);
    REQUIRE(tick(at_between).sequence == patch->sequence);
    const RelevancePatch& kept = memory->object();
    CHECK(is_set(kept, 60, 20, 32));  // what is new of it grows
    CHECK(is_set(kept, 60, 40, 32));
    CHECK(!is_set(kept, 24, 30, 32));
    CHECK(memory->contacts == 1);
}

TEST_CASE("of several objects in the ball the one whose voxel is nearest to the probe is touched, on every side")
{
    const auto patch = std::make_unique<RelevancePatch>(), grown = std::make_unique<RelevancePatch>();
    const auto list = std::make_unique<GrowthList>();
    const Rod low{.point = {32.0, 28.0, 32.0}, .radius = 1.5}, high{.point = {32.0, 36.0, 32.0}, .radius = 1.5};
    fill_patch(*patch, {0, 0, 0}, glm::ivec3(64), glm::dvec3(1),
               [&](const glm::dvec3& p) { return low.holds(p) || high.holds(p); });
    for (const double y : {29.5, 31.5, 32.5, 34.5}) {
        CAPTURE(y);
        begin_growth(*patch, *grown, *list);
        REQUIRE(seed_nearest(*patch, {32.2, y, 31.8}, 8.0, *grown, *list));
        grow(*patch, *grown, *list, ~0u);
        CHECK(is_set(*grown, 5, 28, 32) == (y < 32.0));
        CHECK(is_set(*grown, 5, 36, 32) == (y > 32.0));
    }
}
