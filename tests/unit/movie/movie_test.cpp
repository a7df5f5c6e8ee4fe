#include "engine/movie/movie.h"

#include <set>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/movie/camera_path.h"

using namespace shvr;

namespace {

VolumeInfo cube()
{
    VolumeInfo volume;
    volume.size = {20, 20, 20};
    volume.spacing = glm::dvec3(1.0);
    return volume;
}

MovieView view_from(const std::string& side, double ambient = 0.3)
{
    MovieView view{.name = side, .session = {}, .camera = camera_looking(side, cube())};
    view.session.light.ambient = ambient;
    return view;
}

}  // namespace

TEST_CASE("every view has a frame of its own, which is exactly the view")
{
    for (const int frames : {3, 4, 5, 6, 7, 20, 101}) {
        const std::vector<MovieView> views{view_from("front", 0.1), view_from("right", 0.2), view_from("top", 0.4)};
        const Movie movie(views, 0.0, frames, cube());
        std::set<int> numbers;
        for (size_t view = 0; view < views.size(); ++view) {
            const int number = movie.frame_of_view(view);
            numbers.insert(number);
            CHECK(movie.frame(number).camera == views[view].camera);
            CHECK(movie.frame(number).session == views[view].session);
        }
        CHECK(numbers.size() == views.size());
        CHECK(movie.frame_of_view(0) == 0);
        CHECK(movie.frame_of_view(2) == frames - 1);
    }
}

TEST_CASE("frames between two views are between them, slow near each")
{
    const Movie movie({view_from("front", 0.1), view_from("right", 0.5)}, 0.0, 5, cube());
    const auto ambient = [&](int index) { return movie.frame(index).session.light.ambient; };
    CHECK(ambient(1) == doctest::Approx(0.1 + 0.4 * eased(0.25)));
    CHECK(ambient(2) == doctest::Approx(0.3));
    CHECK(ambient(1) - ambient(0) < ambient(2) - ambient(1));
    CHECK(movie.frame(2).camera == camera_between(movie.views()[0].camera, movie.views()[1].camera, 0.5, cube()));
}

TEST_CASE("a whole turn of the turntable closes: the frame after the last would be the first")
{
    const Movie movie({view_from("front")}, 360.0, 4, cube());
    const std::vector<std::string> sides{"front", "right", "back", "left"};
    for (int index = 0; index < 4; ++index)
        CHECK(glm::distance(movie.frame(index).camera.eye, camera_looking(sides[size_t(index)], cube()).eye) < 1e-9);
    CHECK(movie.frame(0).camera == camera_looking("front", cube()));
    const Movie backwards({view_from("front")}, -360.0, 4, cube());
    CHECK(glm::distance(backwards.frame(1).camera.eye, camera_looking("left", cube()).eye) < 1e-9);
}

TEST_CASE("a turntable turns the way between views, too")
{
    const Movie movie({view_from("front"), view_from("front", 0.5)}, 180.0, 2, cube());
    CHECK(movie.frame(0).camera == camera_looking("front", cube()));
    CHECK(glm::distance(movie.frame(1).camera.eye, camera_looking("right", cube()).eye) < 1e-9);
    CHECK(movie.frame(1).session.light.ambient == 0.5);
}

TEST_CASE("views that no movie can join are refused")
{
    MovieView flat = view_from("right");
    flat.camera.projection = Camera::Projection::orthographic;
    CHECK_THROWS_WITH_AS(Movie({view_from("front"), flat}, 0.0, 4, cube()),
                         "view \"right\" is orthographic, and view \"front\" is perspective; expected the same "
                         "projection in all views of a movie",
                         Error);
    CHECK_THROWS_WITH_AS(Movie({view_from("front"), view_from("top")}, 0.0, 1, cube()),
                         "a movie of 1 frame cannot show 2 views; expected at least one frame for each view", Error);
}

TEST_CASE("names of frames sort by number, and are recognised")
{
    CHECK(frame_file(0, 4) == "frame-0001.png");
    CHECK(frame_file(9999, 12000) == "frame-10000.png");
    CHECK(frame_file(0, 12000) == "frame-00001.png");
    CHECK(number_of_frame_file("frame-0012.png") == 12);
    for (const char* other : {"frame-12.png", "frame-001x.png", "frame-0001.pngx", "aframe-0001.png", "frame-.png",
                              "frame-0001.tif", "frame-00000001.png"})
        CHECK(!number_of_frame_file(other));
}
