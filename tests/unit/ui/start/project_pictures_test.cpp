// Small pictures of projects: their shape, and their names.

#include "engine/workbench/document/project_pictures.h"

#include <doctest/doctest.h>

#include "engine/workbench/models/project_picture.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

/// Columns of one colour each: red rises by one a column.
Image8 columns(int width, int height)
{
    Image8 image{.width = width, .height = height, .rgba = {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int value : {x % 256, 100, y % 256, 255}) image.rgba.push_back(uint8_t(value));
    return image;
}

}  // namespace

TEST_CASE("a small picture shows the middle of the view, in averages")
{
    // Twice as large, and wider: 40 columns at each side are left out.
    const Image8 small = project_picture_of(columns(2 * PROJECT_PICTURE_WIDTH + 80, 2 * PROJECT_PICTURE_HEIGHT));
    CHECK(small.width == PROJECT_PICTURE_WIDTH);
    CHECK(small.height == PROJECT_PICTURE_HEIGHT);
    REQUIRE(small.rgba.size() == size_t(4 * PROJECT_PICTURE_WIDTH * PROJECT_PICTURE_HEIGHT));
    CHECK(int(small.rgba[0]) == 41);  // the mean of 40 and 41, rounded up
    CHECK(int(small.rgba[4]) == 43);
    CHECK(int(small.rgba[1]) == 100);
    CHECK(int(small.rgba[3]) == 255);
    // Smaller than the small picture, and empty: no voxel is read outside.
    CHECK(project_picture_of(columns(3, 2)).rgba.size() == small.rgba.size());
    CHECK(project_picture_of({}).rgba.size() == small.rgba.size());
}

TEST_CASE("each path has a picture of its own name")
{
    const std::filesystem::path folder = "/pictures";
    CHECK(project_picture_file(folder, "/a/b") == project_picture_file(folder, "/a/b"));
    CHECK(project_picture_file(folder, "/a/b") != project_picture_file(folder, "/a/c"));
    CHECK(project_picture_file(folder, "/a/b").parent_path() == folder);
    CHECK(project_picture_file(folder, "/a/b").extension() == ".png");
}
