// Pictures where levels of detail meet.

#include <set>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "tests/gpu/paging/paged_scenes.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("an even medium is as opaque at every level of detail, and where levels meet")
{
    const auto source = std::make_shared<Plain>(Size3(256), 4);
    Session session = session_of(0.01, false);
    session.transfer_function = TransferFunction({{0.0, glm::dvec3(1.0), 0.01}, {255.0, glm::dvec3(1.0), 0.01}});
    session.render.background = glm::dvec4(0.0);
    session.render.size = {24, 24};
    Camera along = camera_looking("front", source->info());
    along.projection = Camera::Projection::orthographic;
    Camera near = camera_looking("front", source->info());
    near.eye = glm::dvec3(128.0, 10.0, 128.0);
    near.target = glm::dvec3(128.0, 200.0, 140.0);
    Budgeted all;
    const double depth = 256.0 * -std::log(0.99);
    const Picture finest = all.picture(source, session, Paging::always, near);
    std::set<uint64_t> loads;
    for (const double detail : {0.0, 2.0, 1.0, 0.5, 0.25}) {
        CAPTURE(detail);
        session.render.detail = detail;
        const ImageF slab = all.picture(source, session, Paging::always, along).image;
        loads.insert(all.counts().uploads);
        const size_t middle = 4 * (12 * 24 + 12) + 3;
        check_below("opacity of a slab", std::abs(double(slab.rgba[middle]) - (1.0 - std::exp(-depth))), 1e-4);
        const ImageF inside = all.picture(source, session, Paging::always, near).image;
        double worst = 0.0;
        for (size_t i = 0; i < inside.rgba.size(); ++i)
            worst = std::max(worst, std::abs(double(inside.rgba[i]) - double(finest.image.rgba[i])));
        check_below("opacity against the finest level's", worst, 1e-4);
    }
    CHECK(loads.size() >= 2);  // not of one level alone
}

TEST_CASE("pre-integrated steps have the same bits with and without leaps where levels meet")
{
    Budgeted all;
    Session session = session_of(0.3, true);
    session.transfer_function =
        TransferFunction({{70.0, glm::dvec3(0.8, 0.3, 0.1), 0.2}, {90.0, glm::dvec3(1.0), 0.4}});
    session.render.preintegration = true;
    session.render.step_voxels = 1.0;
    session.render.size = {60, 45};
    size_t coarser = 0;
    for (const char* kind : {"tubes", "speckles"}) {
        const Source source = open_procedural({.kind = kind, .size = Size3(192), .seed = 3});
        all.load(source, session, Paging::always);
        for (const glm::dvec3& target : {glm::dvec3(110, 190, 100), glm::dvec3(20, 150, 60), glm::dvec3(96, 60, 5)})
            for (const double detail : {0.5, 0.25}) {
                CAPTURE(std::string(kind));
                CAPTURE(detail);
                Camera camera = camera_looking("front", source->info());
                camera.eye = glm::dvec3(96.0, 10.0, 96.0);
                camera.target = target;
                session.render.detail = detail;
                const ImageF leaping = all.renderer.render(session, camera).image;
                session.render.skip_empty_space = false;
                CHECK(different_bits(all.renderer.render(session, camera).image, leaping) == 0);
                session.render.skip_empty_space = true;
                session.render.detail = 0.0;
                coarser += different_bits(all.renderer.render(session, camera).image, leaping);
            }
    }
    CHECK(coarser > 10000);  // levels differ
}
