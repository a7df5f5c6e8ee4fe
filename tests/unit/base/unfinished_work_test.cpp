#include <doctest/doctest.h>

#include <optional>
#include <string>

#include "engine/base/waits/unfinished_work.h"

using namespace shvr;

namespace {

std::string heard;

std::string named()
{
    heard.clear();
    name_unfinished_work([](const char* text) { heard += std::string(text) + "|"; });
    return heard;
}

TEST_CASE("unfinished work is named while it exists, in printable words")
{
    CHECK(named() == "");
    std::optional<UnfinishedWork> first(std::in_place, "a.part keeps what is done");
    const UnfinishedWork second("b\x1b[2J.part");
    CHECK(named() == "a.part keeps what is done|b?[2J.part|");
    first.reset();
    CHECK(named() == "b?[2J.part|");
    const UnfinishedWork shorter("c");
    CHECK(named() == "c|b?[2J.part|");
}

TEST_CASE("unfinished work that finds no room is not named, and takes nobody's place")
{
    const UnfinishedWork long_one(std::string(10'000, 'x'));
    CHECK(named() == "");
    std::optional<UnfinishedWork> many[20];
    for (auto& each : many) each.emplace("x");
    const std::string all = named();
    CHECK(all.size() >= 2);
    for (auto& each : many) each.reset();
    CHECK(named() == "");
    const UnfinishedWork again("y");
    CHECK(named() == "y|");
}

}  // namespace
