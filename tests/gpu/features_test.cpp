// Cost and combination of features. A scene pays only for what it contains: an unused feature has no pass, no byte and
// no bit. Any two features draw together without a validation message.

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

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

ProbeLook probe_of(double ball_share, bool has_shell)
{
    ProbeLook probe{.center = {24.0, 20.0, 22.0}, .radius = 9.0, .color = {0.9, 0.4, 0.1}, .ball_share = ball_share};
    if (has_shell) probe.shell = ShellLook{.threshold = 110.0};
    return probe;
}

std::shared_ptr<const PaintPreview> previewed()
{
    const Change change =
        MaskBrickChange{.brick = 0, .runs = {{.first = 20000, .last = 21500, .before = 0, .after = 3}}};
    return std::make_shared<PaintPreview>(preview_of({&change, 1}, Size3(48), PaintPreview::Kind::group));
}

/// Names of passes with no other feature on; variants of the ray caster are distinguished by their kernel's name.
const std::vector<Feature> FEATURES{
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
    {"adaptive rays",
     [](Scenery& s) { s.session.render.adaptive_tolerance = 0.03; },
     {"raycast coarse", "adaptive", "clear blocks", "clear groups"},
     {"coarse picture", "listed blocks", "groups of listed blocks"}},
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
    {"slices", [](Scenery& s) { s.session.view.arrangement = Arrangement::slices; }, {}}};

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

private:
    Renderer renderer_;
    std::set<std::string> storages_;
    std::shared_ptr<const VolumeSource> source_ = open_procedural({.kind = "tubes", .size = {48, 48, 48}, .seed = 3});
};

std::set<std::string> without_of(std::set<std::string> names, const std::set<std::string>& known)
{
    for (const std::string& name : known) names.erase(name);
    return names;
}

std::set<std::string> names_of(const Picture& picture)
{
    std::set<std::string> names;
    for (const gpu::PassReport& pass : picture.passes) names.insert(pass.name);
    for (const PassData& pass : picture.graph.passes())
        if (!pass.kernel.empty()) names.insert(pass.kernel);
    return names;
}

}  // namespace

TEST_CASE("a scene has the passes and the storages of what is in it, and no others")
{
    // One renderer each: temporary memory is kept for reuse.
    const auto drawn = [](const Scenery& scenery) {
        Everything everything;
        const std::set<std::string> names = names_of(everything.draw(scenery));
        return std::pair{names, everything.storages()};
    };
    const Scenery plain = Everything().plain();
    const auto [passes, storages] = drawn(plain);
    CHECK((passes == std::set<std::string>{"leap_occupancy", "leap_distance", "leap_distance x", "leap_distance y",
                                           "leap_distance z", "sample_bits", "upload transfer function", "raycast",
                                           "read back color"}));
    const auto without = [](const std::set<std::string>& names, const std::set<std::string>& known) {
        std::string list;
        for (const std::string& name : without_of(names, known)) list += name + "; ";
        return list;
    };
    for (const Feature& feature : FEATURES) {
        CAPTURE(std::string(feature.name));
        Scenery scenery = plain;
        feature.add(scenery);
        const auto [more_passes, more_storages] = drawn(scenery);
        CHECK(without(without_of(more_passes, passes), feature.passes) == "");
        CHECK(without(feature.passes, more_passes) == "");
        CHECK(without(without_of(more_storages, storages), feature.storages) == "");
        CHECK(without(feature.storages, more_storages) == "");
    }
}

TEST_CASE_FIXTURE(Everything, "what a feature had is given back with it")
{
    const std::set<std::string> lasting{"mask",          "mask table",    "occlusion cells", "occlusion values",
                                        "surface list",  "surface nodes", "cell leap",       "brick staging",
                                        "page directory"};
    for (const Feature& feature : FEATURES) {
        CAPTURE(std::string(feature.name));
        Scenery scenery = plain();
        feature.add(scenery);
        draw(scenery);
        draw(plain());
        for (const std::string& name : storages()) CHECK_MESSAGE(!lasting.contains(name), name, " is still there");
    }
}

TEST_CASE_FIXTURE(Everything, "neutral settings change no bit")
{
    const Scenery plain = this->plain();
    const ImageF image = draw(plain).image;
    const std::pair<const char*, std::function<void(Scenery&)>> neutral[] = {
        {"blend of size 0", [](Scenery& s) { s.session.blend = {.size = 0.0, .rate = 3.0, .color = GREEN}; }},
        {"occlusion of strength 0", [](Scenery& s) { s.session.light.occlusion = {.strength = 0.0, .radius = 9.0}; }},
        {"occlusion without shading", [](Scenery& s) { s.session.light.occlusion = {.strength = 1.0}; }},
        {"a shell of opacity 0",
         [](Scenery& s) {
             s.options.probe = probe_of(0.0, true);
             s.options.probe->shell->opacity = 0.0;
         }},
        {"a preview of nothing",
         [](Scenery& s) {
             s.options.probe = probe_of(0.0, false);
             s.options.probe->preview = std::make_shared<PaintPreview>();
         }},
        {"a cut around everything",
         [](Scenery& s) {
             s.session.cut = {{0, 0, 0}, {48, 48, 48}};
         }},
        {"eyes at no distance",
         [](Scenery& s) {
             s.session.view.arrangement = Arrangement::stereo;
             s.session.view.stereo = {.output = StereoOutput::anaglyph, .eye_distance = 0.0};
         }},
        {"bricks that come and go", [](Scenery& s) { s.paging = Paging::always; }},
        {"no leaps", [](Scenery& s) { s.session.render.skip_empty_space = false; }},
        {"smooth borders of nothing", [](Scenery& s) { s.session.render.smooth_borders = true; }},
        {"work counters", [](Scenery& s) { s.options.count_work = true; }},
        {"surfaces out of sight", [](Scenery& s) {
             s.session.surfaces = {{{500, 0, 0}, {501, 0, 0}, 1.0, 1.0, RED}};
         }}};
    for (const auto& [name, apply] : neutral) {
        CAPTURE(std::string(name));
        Scenery scenery = plain;
        apply(scenery);
        check_below("differing bits", double(different_bits(draw(scenery).image, image)), 0.0);
    }
}

TEST_CASE_FIXTURE(Everything, "any two features go together")
{
    for (size_t a = 0; a < FEATURES.size(); ++a)
        for (size_t b = a + 1; b < FEATURES.size(); ++b) {
            CAPTURE(std::string(FEATURES[a].name));
            CAPTURE(std::string(FEATURES[b].name));
            Scenery scenery = plain();
            FEATURES[a].add(scenery);
            FEATURES[b].add(scenery);
            const Picture picture = draw(scenery);
            CHECK(picture.complete);
            CHECK(picture.warnings.empty());
            size_t wrong = 0;
            for (const float value : picture.image.rgba)
                wrong += !std::isfinite(value) || value < 0.0f || value > 1.001f;
            CHECK(wrong == 0);
            // Paged bricks must change no bit, whatever other features are on.
            if (scenery.paging != Paging::always || scenery.sampling != Sampling::exact) continue;
            scenery.paging = Paging::never;
            check_below("differing bits", double(different_bits(draw(scenery).image, picture.image)), 0.0);
        }
}
