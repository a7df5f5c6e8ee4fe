// Sentences about changed settings.

#include "engine/workbench/words/settings_words.h"

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

namespace {

const IntensityWords WHOLE(VoxelType::uint8, {0.0, 255.0});

Session with_function(double shift)
{
    Session session;
    session.transfer_function =
        TransferFunction({{48.05 + shift, glm::dvec3(0.5), 0.0}, {213.4 + shift, glm::dvec3(1.0), 1.0}});
    return session;
}

}  // namespace

TEST_CASE("thresholds are said as whole numbers where voxels are integers of many values")
{
    Session was, is;
    was.probe.brush.threshold = 177.1;
    is.probe.brush.threshold = 161.0;
    CHECK(change_in_words(was, is, WHOLE) == "Set paint threshold from 177 to 161");
    for (const IntensityWords& exact :
         {IntensityWords(VoxelType::float32, {0.0, 255.0}), IntensityWords(VoxelType::uint8, {170.0, 180.0})})
        CHECK(change_in_words(was, is, exact) == "Set paint threshold from 177.1 to 161");
    is.probe.brush.threshold = 177.3;
    CHECK(change_in_words(was, is, WHOLE) == "Set paint threshold from 177.1 to 177.3");
    CHECK(change_in_words(was, was, WHOLE).empty());
    is.light.ambient = 0.5;
    is.probe.brush.threshold = 161.0;
    CHECK(change_in_words(was, is, WHOLE) == "Set ambient light from 0.3 to 0.5; set paint threshold from 177 to 161");
}

TEST_CASE("a transfer function is said by whole numbers, too, and a small shift as it is")
{
    CHECK(change_in_words({}, with_function(0.0), WHOLE) == "Transfer function of 2 points, from 48 to 213");
    CHECK(change_in_words(with_function(0.0), with_function(3.4), WHOLE) == "Transfer function shifted by 3");
    CHECK(change_in_words(with_function(0.0), with_function(0.5), WHOLE) == "Transfer function shifted by 0.5");
    CHECK(change_in_words({}, with_function(0.0), IntensityWords(VoxelType::float32, {0.0, 1000.0})) ==
          "Transfer function of 2 points, from 48.05 to 213.4");
}
