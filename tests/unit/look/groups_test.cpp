#include "engine/look/groups.h"

#include <doctest/doctest.h>

using namespace shvr;

TEST_CASE("a group is locked where it or any group above it is")
{
    Groups groups;
    groups[1].locked = true;
    groups[2].parent = 1;
    groups[3].parent = 2;
    groups[4].parent = 5;  // which has no entry
    groups[6] = {.name = "leaf", .parent = 3, .visible = false};
    for (const int locked : {1, 2, 3, 6}) CHECK(is_locked(groups, uint8_t(locked)));
    for (const int open : {0, 4, 5, 7, 255}) CHECK_FALSE(is_locked(groups, uint8_t(open)));
    const std::bitset<256> all = locked_groups(groups);
    for (int group = 0; group < 256; ++group) CHECK(all[size_t(group)] == is_locked(groups, uint8_t(group)));

    groups[1].locked = false;
    CHECK(locked_groups(groups).none());
    groups[3].locked = true;
    CHECK(locked_groups(groups).count() == 2);
    CHECK(is_locked(groups, 6));
    CHECK_FALSE(is_locked(groups, 2));
}

TEST_CASE("a lock changes no look")
{
    Groups groups;
    groups[2] = {.name = "vein", .color = glm::dvec3(0.5), .opacity = 0.25};
    const ColorGroup before = group_of(groups, 2);
    groups[2].locked = true;
    CHECK(group_of(groups, 2) == before);
}
