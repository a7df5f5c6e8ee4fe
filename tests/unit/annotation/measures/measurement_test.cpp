// Distances, paths and angles: values in closed form, also where voxels are no cubes, and the table of them.

#include "engine/annotation/measures/measurement.h"

#include <doctest/doctest.h>

using namespace shvr;

namespace {

const glm::dvec3 CUBES(1.0), SLABS(2.0, 2.0, 9.0);

}  // namespace

TEST_CASE("lengths are physical: each side of a path counts with the spacing of its axes")
{
    const Measurement distance{{{10, 10, 10}, {13, 14, 10}}};
    CHECK(length_of(distance, CUBES) == doctest::Approx(5.0));
    CHECK(length_of(distance, SLABS) == doctest::Approx(10.0));
    const Measurement path{{{0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {3, 4, 2}}, MeasureKind::path};
    CHECK(length_of(path, CUBES) == doctest::Approx(9.0));
    CHECK(length_of(path, SLABS) == doctest::Approx(6.0 + 8.0 + 18.0));
    CHECK(length_of({{{5, 5, 5}}}, SLABS) == 0.0);
}

TEST_CASE("angles are those of physical space, not of voxels")
{
    const auto angle = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& spacing) {
        const glm::dvec3 vertex(7, 8, 9);
        return angle_of({{vertex + a, vertex, vertex + b}, MeasureKind::angle}, spacing).value_or(-1.0);
    };
    CHECK(angle({1, 0, 0}, {0, 0, 1}, SLABS) == doctest::Approx(90.0));
    CHECK(angle({1, 0, 0}, {1, 0, 1}, CUBES) == doctest::Approx(45.0));
    CHECK(angle({1, 0, 0}, {1, 0, 1}, {1.0, 1.0, std::sqrt(3.0)}) == doctest::Approx(60.0));
    CHECK(angle({1, 0, 0}, {-2, 0, 0}, SLABS) == doctest::Approx(180.0));
    CHECK(angle({1, 2, 3}, {2, 4, 6}, SLABS) == doctest::Approx(0.0));
    CHECK(angle({1, 0, 0}, {1, 0, 1e-9}, CUBES) == doctest::Approx(1e-9 * 180.0 / 3.14159265358979).epsilon(1e-6));
    CHECK(angle({0, 0, 0}, {1, 0, 0}, CUBES) == -1.0);  // a side without a length
    CHECK(!angle_of({{{0, 0, 0}, {1, 0, 0}}}, CUBES));
}

TEST_CASE("each kind has its number of points")
{
    CHECK(is_count_of(MeasureKind::distance, 2));
    CHECK(!is_count_of(MeasureKind::distance, 3));
    CHECK(is_count_of(MeasureKind::angle, 3));
    CHECK(!is_count_of(MeasureKind::angle, 2));
    CHECK(!is_count_of(MeasureKind::path, 1));
    CHECK(is_count_of(MeasureKind::path, MAX_MEASURED_POINTS));
    CHECK(!is_count_of(MeasureKind::path, MAX_MEASURED_POINTS + 1));
}

TEST_CASE("a new name is none of those in use, also after one between was removed")
{
    const std::vector<glm::dvec3> ends{{0, 0, 0}, {1, 0, 0}};
    std::vector<Measurement> all;
    CHECK(unused_name(all, MeasureKind::path) == "Path 1");
    all = {{ends}, {ends, MeasureKind::distance, "Distance 3"}, {ends, MeasureKind::path, "stem"}};
    CHECK(name_of(all[0], 1) == "Distance 1");  // has no name of its own
    CHECK(unused_name(all, MeasureKind::distance) == "Distance 2");
    CHECK(unused_name(all, MeasureKind::path) == "Path 1");
}

TEST_CASE("the table has units in its headings, and one row a measurement")
{
    const Measurement all[] = {{{{10, 10, 10}, {13, 14, 10}}, MeasureKind::distance, "stem, left"},
                               {{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}}, MeasureKind::angle, "=1+1\tx"}};
    const TraceSpace space{.size = Size3(20), .spacing = SLABS, .unit = "um"};
    CHECK(measurements_table(all, space, Positions::volume, ',') ==
          "number,name,kind,length_um,angle_degrees,points_um_from_corner\r\n"
          "1,\"stem, left\",distance,10,,20 20 90; 26 28 90\r\n"
          "2,'=1+1 x,angle,,90,2 0 0; 0 0 0; 0 2 0\r\n");
    const std::string tabs = measurements_table(std::span(all, 1), space, Positions::physical, '\t');
    CHECK(tabs ==
          "number\tname\tkind\tlength_um\tangle_degrees\tpoints_um_physical\n"
          "1\t\"stem, left\"\tdistance\t10\t\t19 19 85.5; 25 27 85.5\n");
}
