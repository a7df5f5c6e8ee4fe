// Every pair of features in a picture of its own. features_test.cpp covers all pairs of values with a few pictures of
// many features, in which one feature could hide an error of two others.

#include <doctest/doctest.h>

#include "tests/gpu/matrix/feature_list.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE_FIXTURE(Everything, "any two features go together, without a third")
{
    for (size_t a = 0; a < FEATURES.size(); ++a)
        for (size_t b = a + 1; b < FEATURES.size(); ++b) {
            CAPTURE(std::string(FEATURES[a].name));
            CAPTURE(std::string(FEATURES[b].name));
            Scenery scenery = plain();
            FEATURES[a].add(scenery);
            FEATURES[b].add(scenery);
            check(scenery);
        }
}
