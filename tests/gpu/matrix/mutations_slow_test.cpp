// Every golden against every wrong rendering: which ones notice, and that those in golden_test.cpp are among them.
// $SHVR_GOLDEN_VERBOSE prints the matrix.

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>

#include <doctest/doctest.h>

#include "engine/base/image_file.h"
#include "tests/gpu/matrix/wrong_renderings.h"

using namespace shvr;
using namespace shvr::test;
using golden::Golden;
using golden::Studio;

TEST_CASE("every wrong rendering fails goldens, among them the one that it names")
{
    std::map<std::string, std::vector<std::string>> caught_by;
    for (const Golden& one : golden::goldens_in("tests/golden")) {
        const Image8 blessed = read_png(one.picture());
        Studio studio(one);
        if (golden::why_different(studio.draw(), blessed, one.strictness)) continue;  // it fails unchanged
        for (const Mutation& mutation : MUTATIONS)
            if (why_noticed(mutation, one, studio, blessed)) caught_by[mutation.name].push_back(one.name);
    }
    for (const Mutation& mutation : MUTATIONS) {
        const std::vector<std::string>& names = caught_by[mutation.name];
        INFO(mutation.name);
        CHECK(std::ranges::count(names, mutation.golden) == 1);
        if (std::getenv("SHVR_GOLDEN_VERBOSE")) {
            std::cout << mutation.name << ": caught by " << names.size() << ":";
            for (const std::string& name : names) std::cout << ' ' << name;
            std::cout << '\n';
        }
    }
}
