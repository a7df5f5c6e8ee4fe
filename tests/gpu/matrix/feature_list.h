#pragma once
// Features of a picture, and a renderer that draws any of them together: shared by features_test.cpp, which draws a
// covering array of them, and pairs_slow_test.cpp, which draws every pair.

#include <cmath>
#include <functional>
#include <set>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/support/gpu.h"
#include "tests/support/stored_volume.h"

namespace shvr::test {

struct Scenery {
    Session session;
    Camera camera;
    RenderOptions options;
    Paging paging = Paging::never;
    Sampling sampling = Sampling::exact;
    bool is_painted = false;
};

struct Feature {
    const char* name;
    std::function<void(Scenery&)> add;
    std::set<std::string> passes;      ///< passes that it adds
    std::set<std::string> storages{};  ///< storages that it adds on the device
};

inline ProbeLook probe_of(double ball_share, bool has_shell)
{
    ProbeLook probe{.center = {24.0, 20.0, 22.0}, .radius = 9.0, .color = {0.9, 0.4, 0.1}, .ball_share = ball_share};
    if (has_shell) probe.shell = ShellLook{.threshold = 110.0};
    return probe;
}

inline std::shared_ptr<const PaintPreview> previewed()
{
    const Change change =
        MaskBrickChange{.brick = 0, .runs = {{.first = 20000, .last = 21500, .before = 0, .after = 3}}};
    return std::make_shared<PaintPreview>(preview_of({&change, 1}, Size3(48), PaintPreview::Kind::group));
}

/// Names of passes with no other feature on; variants of the ray caster are distinguished by their kernel's name.
inline const std::vector<Feature> FEATURES{
    {"shading", [](Scenery& s) { s.session.light.shaded = true; }, {}},
    {"paint",
     [](Scenery& s) { s.is_painted = true; },
     {"raycast_masked", "leap_occupancy_masked", "upload groups"},
     {"mask", "mask bricks", "mask table", "mask table entries", "groups", "groups entries", "region bits",
      "region parents"}},
    {"ambient occlusion",
     [](Scenery& s) {
         s.session.light.shaded = true;
         s.session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 8};
     },
     {"raycast_occluded", "occlusion_cells", "occlusion_gather", "occlusion_bake", "clear occlusion scratch",
      "begin occlusion values", "clear occlusion cells", "start occlusion"},
     {"occlusion cells", "occlusion scratch", "occlusion start", "occlusion values"}},
    {"distance blending", [](Scenery& s) { s.session.blend = {.size = 0.7, .color = RED}; }, {}},
    {"ball of the probe",
     [](Scenery& s) { s.options.probe = probe_of(0.5, s.options.probe && s.options.probe->shell); },
     {"surfaces", "raycast_surfaced"},
     {"surfaces"}},
    {"iso-surface around the probe",
     [](Scenery& s) { s.options.probe = probe_of(s.options.probe ? 0.5 : 0.0, true); },
     {"raycast_shelled"},
     {"rays"}},
    {"preview of the brush",
     [](Scenery& s) {
         if (!s.options.probe) s.options.probe = probe_of(0.0, false);
         s.options.probe->preview = previewed();
     },
     {"preview", "preview_over", "raycast_surfaced"},
     {"preview", "preview surfaces"}},
    {"surfaces",
     [](Scenery& s) {
         s.session.surfaces = {{{10, 10, 10}, {40, 30, 35}, 2.0, 4.0, GREEN}};
     },
     {"surface_tiles", "surfaces", "surfaces_listed", "raycast_surfaced", "upload surface list",
      "upload surface nodes"},
     {"surfaces", "surface tiles", "surface list", "surface list to upload", "surface nodes",
      "surface nodes to upload"}},
    {"cutting planes",
     [](Scenery& s) {
         s.session.cut = {{5, 6, 7}, {40, 38, 36}};
     },
     {}},
    {"oblique cutting plane",
     [](Scenery& s) {
         s.session.cut.plane_normal = glm::dvec3(0.5, -1.0, 0.7);
         s.session.cut.plane_point = glm::dvec3(22.0, 15.0, 25.0);
     },
     {}},
    {"clip planes",
     [](Scenery& s) {
         s.camera.near_distance = 90.0;
         s.camera.far_distance = 130.0;
     },
     {}},
    {"orthographic camera",
     [](Scenery& s) {
         s.camera.projection = Camera::Projection::orthographic;
         s.camera.height = 60.0;
     },
     {}},
    {"translucent background",
     [](Scenery& s) {
         s.session.render.background = {0.1, 0.2, 0.3, 0.5};
     },
     {}},
    {"work counters", [](Scenery& s) { s.options.count_work = true; }, {}, {"work counters"}},
    {"pre-integration", [](Scenery& s) { s.session.render.preintegration = true; }, {}},
    {"translucent ball",
     [](Scenery& s) {
         if (!s.options.probe) s.options.probe = probe_of(0.5, false);
         s.options.probe->ball_opacity = 0.5;
     },
     {"surfaces", "raycast_surfaced", "mix"},
     {"surfaces"}},  // and the picture without the probe, in the same memory
    {"saturation", [](Scenery& s) { s.session.render.saturation = 0.3; }, {"saturation"}},
    {"no leaps", [](Scenery& s) { s.session.render.skip_empty_space = false; }, {}},
    {"smooth borders", [](Scenery& s) { s.session.render.smooth_borders = true; }, {}},
    {"bricks that come and go",
     [](Scenery& s) { s.paging = Paging::always; },
     {"raycast_paged", "brick_leap", "what rays came by", "clear reached", "upload page directory"},
     {"brick staging", "cell leap", "page directory", "page directory entries", "rays", "reached"}},
    {"filtered sampling", [](Scenery& s) { s.sampling = Sampling::hardware; }, {"raycast_filtered"}},
    {"two eyes", [](Scenery& s) { s.session.view.arrangement = Arrangement::stereo; }, {}},
    {"anaglyph",
     [](Scenery& s) {
         s.session.view.arrangement = Arrangement::stereo;
         s.session.view.stereo.output = StereoOutput::anaglyph;
     },
     {"anaglyph"},
     {"left eye", "right eye"}},
    {"overview", [](Scenery& s) { s.session.view.arrangement = Arrangement::overview; }, {}},
    {"slices", [](Scenery& s) { s.session.view.arrangement = Arrangement::slices; }, {"slice"}}};

class Everything {
public:
    Everything() : renderer_({.device = {.validation = true}, .threads = 2}) {}
    ~Everything()
    {
        for (const std::string& message : renderer_.device().take_validation_messages()) FAIL_CHECK(message);
    }
    Scenery plain() const
    {
        Scenery scenery;
        scenery.session = plain_session({{100.0, WHITE, 0.0}, {140.0, RED, 0.3}, {255.0, WHITE, 0.5}}, {48, 36});
        scenery.camera = perspective({24, -90, 40}, {24, 24, 24}, 30.0);
        return scenery;
    }
    Picture draw(const Scenery& scenery)
    {
        Session session = scenery.session;
        session.render.paging = scenery.paging;
        session.render.sampling = scenery.sampling;
        session.render.detail = 0.0;
        session.probe.voxel = glm::dvec3(24.5, 20.5, 22.5);
        renderer_.load(source_, {.minimum = 0.0, .maximum = 255.0}, session.render);
        renderer_.scene().set_surfaces(session.surfaces);
        Annotator annotator(renderer_);
        if (scenery.is_painted) {
            PaintOp paint{.brush = Brush::fill,
                          .region = RegionShape::ball,
                          .group = 2,
                          .threshold = 90.0,
                          .radius_voxels = 12.0,
                          .path = {glm::dvec3(24.5)}};
            REQUIRE(annotator.paint(paint) > 0);
        }
        Picture picture = renderer_.render(session, scenery.camera, scenery.options);
        storages_.clear();
        for (const auto& [name, bytes] : renderer_.memory().bytes_by_name())
            if (bytes > 0) storages_.insert(name);
        return picture;
    }
    const std::set<std::string>& storages() const { return storages_; }
    /// Draws a picture of several features, checks every value of it, and that paged bricks change no bit of it.
    Picture check(Scenery scenery)
    {
        Picture picture = draw(scenery);
        CHECK(picture.complete);
        CHECK(picture.warnings.empty());
        size_t wrong = 0;
        for (const float value : picture.image.rgba) wrong += !std::isfinite(value) || value < 0.0f || value > 1.001f;
        CHECK(wrong == 0);
        if (scenery.paging != Paging::always || scenery.sampling != Sampling::exact) return picture;
        scenery.paging = Paging::never;
        check_below("differing bits", double(different_bits(draw(scenery).image, picture.image)), 0.0);
        return picture;
    }

private:
    Renderer renderer_;
    std::set<std::string> storages_;
    std::shared_ptr<const VolumeSource> source_ = stored_volume("tubes", {48, 48, 48}, 3);
};

}  // namespace shvr::test
