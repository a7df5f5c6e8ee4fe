// The four qualities as data, as a key, and what of a session makes its look.

#include "engine/session/quality.h"

#include <set>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/session/session.h"
#include "engine/session/session_patch.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const std::string SMALLEST = R"({"shvr_session": 1, "volume": {"path": "a.nhdr"}})";

Session parse(const std::vector<std::string>& settings = {}, const std::string& text = SMALLEST)
{
    return parse_session(text, "/data/scans", "s.json", settings);
}

std::string name_of(const RenderSettings& render)
{
    const auto quality = quality_of(render);
    return quality ? quality->name : "";
}

}  // namespace

TEST_CASE("each quality is found again, is valid, and costs no less than the one before")
{
    std::set<std::string> names;
    double step = 100.0, detail = 0.0;
    for (const Quality& quality : qualities()) {
        CAPTURE(quality.name);
        RenderSettings render;
        take(render, quality);
        CHECK(name_of(render) == quality.name);
        CHECK(names.insert(quality.name).second);
        CHECK((quality.exact_integral || quality.step_voxels < step));
        step = quality.step_voxels;
        // Voxels for each pixel at least: more is finer, and 0 is the finest.
        CHECK((quality.detail == 0.0 || quality.detail >= detail));
        detail = quality.detail == 0.0 ? 100.0 : quality.detail;
        CHECK((!(quality.preintegration || quality.exact_integral) || quality.step_voxels <= 1.0));
        render.size = {7, 7};  // not one of its keys
        CHECK(name_of(render) == quality.name);
        render.step_voxels *= 1.01;
        CHECK(name_of(render).empty());
    }
    CHECK(name_of(RenderSettings{}) == "interactive");
}

TEST_CASE("--set render.quality takes the place of what a file holds, and later settings win")
{
    CHECK(name_of(parse({"render.quality=draft"}).render) == "draft");
    const std::string written = to_text(parse({"render.quality=reference", "render.saturation=0.5"}), "/data/scans");
    CHECK(written.find("quality") == std::string::npos);
    const Session draft = parse({"render.quality=draft"}, written);
    CHECK(name_of(draft.render) == "draft");
    CHECK(draft.render.saturation == 0.5);
    CHECK(parse({"render.quality=good", "render.step_voxels=0.3"}).render.step_voxels == 0.3);
    CHECK(parse({"render.step_voxels=0.3", "render.quality=good"}).render.step_voxels == 0.125);
    const std::string refused = error_of([] { parse({"render.quality=best"}); });
    CHECK_MESSAGE(contains(refused, "\"reference\""), refused);
}

TEST_CASE("a file may name a quality; the keys beside it win")
{
    const std::string text =
        R"({"shvr_session": 1, "volume": {"path": "a.nhdr"}, "render": {"quality": "draft", "detail": 3}})";
    const Session session = parse({}, text);
    CHECK(session.render.step_voxels == 1.0);
    CHECK(session.render.detail == 3.0);
}

TEST_CASE("a patch with a quality changes all of its keys")
{
    const Session before = parse({"render.quality=reference"});
    const Session after = patched(before, R"({"render": {"quality": "draft"}})");
    CHECK(name_of(after.render) == "draft");
}

TEST_CASE("a look is the session's own where nothing is left out")
{
    Session session = parse({"groups.3.name=a"});
    session.transfer_function = TransferFunction({{1.0, glm::dvec3(1), 0.25}, {2.0, glm::dvec3(1), 0.5}});
    const Look look = session.look();
    CHECK(look.transfer_function == session.transfer_function);
    CHECK(look.groups == session.groups);
    CHECK(look.cut == session.cut);
    CHECK(look.shows_meshes);
}

TEST_CASE("what is unpainted has an opacity of its own, which multiplies the transfer function's")
{
    Session session = parse({"unpainted.opacity=0.5"});
    session.transfer_function = TransferFunction({{1.0, glm::dvec3(1), 0.25}, {2.0, glm::dvec3(1), 0.5}});
    for (const double intensity : {1.0, 1.4, 2.0})
        CHECK(session.look().transfer_function.at(intensity).a ==
              doctest::Approx(0.5 * session.transfer_function.at(intensity).a));
    session.unpainted.visible = false;
    CHECK(session.look().transfer_function.draws_nothing());
    CHECK(session.look().groups == session.groups);
}

TEST_CASE("a group alone hides all others but those below it, and no setting of theirs is lost")
{
    Session session = parse({"groups.5.parent=3", "groups.4.opacity=0.5", "view.solo=3"});
    session.transfer_function = TransferFunction({{1.0, glm::dvec3(1), 0.25}, {2.0, glm::dvec3(1), 0.5}});
    const Look look = session.look();
    for (int group = 1; group < 256; ++group)
        CHECK(group_of(look.groups, uint8_t(group)).visible == (group == 3 || group == 5));
    CHECK(look.transfer_function.draws_nothing());
    CHECK(group_of(look.groups, 4).opacity == 0.5);
    session.view.solo = 0;
    CHECK_FALSE(session.look().transfer_function.draws_nothing());
    CHECK_FALSE(group_of(session.look().groups, 3).visible);
}

TEST_CASE("without the volume nothing of it is left, and its transfer function stays")
{
    Session session = parse({"view.volume=false", "view.meshes=false", "cut.lower=[3,4,5]"});
    const Look look = session.look();
    CHECK(look.cut.lower == look.cut.upper);
    CHECK_FALSE(look.shows_meshes);
}
