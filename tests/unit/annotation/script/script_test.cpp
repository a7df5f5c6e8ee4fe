#include "engine/annotation/script/script.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

std::vector<ScriptLine> script_of(const std::string& text)
{
    const TemporaryFolder folder;
    return read_script(folder.write("a.jsonl", text));
}

/// The only operation of a script of one line.
template <class Op>
Op op_of(const std::string& line)
{
    const std::vector<ScriptLine> script = script_of(line);
    REQUIRE(script.size() == 1);
    REQUIRE(std::holds_alternative<Op>(script[0].op));
    return std::get<Op>(script[0].op);
}

std::string refusal(const std::string& text)
{
    return error_of([&] { script_of(text); });
}

/// A complete line of paint, with `keys` in place of those of the same name.
std::string paint(const std::vector<std::pair<std::string, std::string>>& keys)
{
    std::vector<std::pair<std::string, std::string>> all = {{"op", "\"paint\""}, {"brush", "\"flood\""},
                                                            {"group", "3"},      {"threshold", "120"},
                                                            {"radius", "6"},     {"path", "[[1,2,3]]"}};
    for (const auto& [key, value] : keys) {
        const auto same = [&, &k = key](const auto& pair) { return pair.first == k; };
        const auto found = std::find_if(all.begin(), all.end(), same);
        if (found == all.end())
            all.emplace_back(key, value);
        else
            found->second = value;
    }
    std::string line = "{";
    for (const auto& [key, value] : all)
        if (!value.empty()) line += (line.size() > 1 ? ",\"" : "\"") + key + "\":" + value;
    return line + "}";
}

}  // namespace

TEST_CASE("a line of paint is read with every key")
{
    const auto op =
        op_of<PaintOp>(R"({"op":"paint","brush":"speckle","region":"box","group":255,"threshold":-12.5,"radius":0.25,)"
                       R"("connectivity":26,"path":[[1,2,3],[4.5,-6e1,7]]})");
    CHECK(op.brush == Brush::speckle);
    CHECK(op.region == RegionShape::box);
    CHECK(op.group == 255);
    CHECK(op.threshold == -12.5);
    CHECK(op.radius_voxels == 0.25);
    CHECK(op.connectivity == 26);
    CHECK(op.path == std::vector<glm::dvec3>{{1.0, 2.0, 3.0}, {4.5, -60.0, 7.0}});
}

TEST_CASE("a line of paint without region and connectivity means a ball and 6")
{
    const auto op = op_of<PaintOp>(paint({}));
    CHECK(op.brush == Brush::flood);
    CHECK(op.region == RegionShape::ball);
    CHECK(op.connectivity == 6);
    CHECK(op.group == 3);
    CHECK(op_of<PaintOp>(paint({{"brush", "\"fill\""}})).brush == Brush::fill);
    CHECK(op_of<PaintOp>(paint({{"region", "\"ball\""}, {"group", "0"}, {"radius", "127.5"}})).radius_voxels == 127.5);
}

TEST_CASE("a line of paint or density may be held to unpainted voxels")
{
    CHECK_FALSE(op_of<PaintOp>(paint({})).only_unpainted);
    CHECK_FALSE(op_of<PaintOp>(paint({{"only_unpainted", "false"}, {"group", "0"}})).only_unpainted);
    CHECK(op_of<PaintOp>(paint({{"only_unpainted", "true"}})).only_unpainted);
    CHECK(op_of<PaintOp>(paint({{"op", "\"density\""}, {"only_unpainted", "true"}})).only_unpainted);
    CHECK_FALSE(
        op_of<PaintOp>(paint({{"op", "\"density\""}, {"only_unpainted", "false"}, {"group", ""}})).only_unpainted);
    CHECK(op_of<PaintOp>(paint({})).locked.none());  // locks are the session's
}

TEST_CASE("undo and redo count, once where nothing is said")
{
    CHECK(op_of<UndoOp>(R"({"op":"undo"})").count == 1);
    CHECK(op_of<UndoOp>(R"({"op":"undo","count":7})").count == 7);
    CHECK(op_of<RedoOp>(R"({"op":"redo"})").count == 1);
    CHECK(op_of<RedoOp>(R"({"op":"redo","count":1000000000})").count == 1000000000);
    op_of<SaveOp>(R"({"op":"save"})");
    op_of<RevertOp>(R"({"op":"revert"})");
}

TEST_CASE("an expectation holds what is written and nothing else")
{
    const auto all = op_of<ExpectOp>(
        R"({"op":"expect","voxels_in_group":{"3":1234,"0":0,"255":5000000000},"nodes":12,"internodes":11})");
    CHECK(all.voxels_in_group == std::map<uint8_t, int64_t>{{0, 0}, {3, 1234}, {255, 5000000000}});
    CHECK(all.nodes == 12);
    CHECK(all.internodes == 11);
    const auto none = op_of<ExpectOp>(R"({"op":"expect"})");
    CHECK(none.voxels_in_group.empty());
    CHECK(!none.nodes.has_value());
    CHECK(!none.internodes.has_value());
}

TEST_CASE("blank lines and comments are skipped, and lines keep their numbers")
{
    const std::vector<ScriptLine> script =
        script_of("\n// what this is\n{\"op\":\"save\"}\r\n  \t \r\n  // {\"op\":\"nonsense\"}\n  {\"op\":\"undo\"}");
    REQUIRE(script.size() == 2);
    CHECK(script[0].number == 3);
    CHECK(std::holds_alternative<SaveOp>(script[0].op));
    CHECK(script[1].number == 6);
    CHECK(std::holds_alternative<UndoOp>(script[1].op));
    CHECK(script_of("").empty());
    CHECK(script_of("\n\n// nothing\n").empty());
}

TEST_CASE("a bad line is refused with its file, line, key and value")
{
    struct BadLine {
        std::string line;
        std::vector<const char*> parts;  // of the message
    };
    const std::vector<BadLine> bad_lines = {
        {paint({{"brush", "\"pencil\""}}), {"key brush is \"pencil\"", R"("fill", "flood", "speckle")"}},
        {paint({{"brush", ""}}), {"key brush is missing"}},
        {paint({{"brush", "1"}}), {"key brush is 1"}},
        {paint({{"region", "\"cube\""}}), {"key region is \"cube\"", R"("ball", "box")"}},
        {paint({{"group", ""}}), {"key group is missing"}},
        {paint({{"group", "256"}}), {"key group is 256", "0 to 255"}},
        {paint({{"group", "-1"}}), {"key group is -1", "0 to 255"}},
        {paint({{"group", "1.5"}}), {"key group is 1.5", "whole"}},
        {paint({{"group", "\"3\""}}), {"key group is \"3\""}},
        {paint({{"group", "18446744073709551615"}}), {"key group is 18446744073709551615"}},
        {paint({{"threshold", ""}}), {"key threshold is missing"}},
        {paint({{"threshold", "\"high\""}}), {"key threshold is \"high\"", "number"}},
        {paint({{"threshold", "null"}}), {"key threshold is null", "number"}},
        {paint({{"threshold", "1e999"}}), {"number"}},
        {paint({{"threshold", "NaN"}}), {"is not JSON"}},
        {paint({{"radius", ""}}), {"key radius is missing"}},
        {paint({{"radius", "0"}}), {"key radius is 0", "above 0"}},
        {paint({{"radius", "-3"}}), {"key radius is -3", "above 0"}},
        {paint({{"radius", "128"}}), {"key radius is 128", "below 128"}},
        {paint({{"radius", "true"}}), {"key radius is true"}},
        {paint({{"connectivity", "18"}}), {"key connectivity is 18", "6 or 26"}},
        {paint({{"connectivity", "6.5"}}), {"key connectivity is 6.5"}},
        {paint({{"connectivity", "27"}}), {"key connectivity is 27"}},
        {paint({{"only_unpainted", "1"}}), {"key only_unpainted is 1", "true or false"}},
        {paint({{"only_unpainted", "\"true\""}}), {"key only_unpainted is \"true\"", "true or false"}},
        {paint({{"only_unpainted", "null"}}), {"key only_unpainted is null", "true or false"}},
        {paint({{"only_unpainted", "true"}, {"group", "0"}}),
         {"only_unpainted is true with group 0", "a group from 1"}},
        {paint({{"op", "\"density\""}, {"only_unpainted", "true"}, {"group", ""}}),
         {"only_unpainted is true without group", "expected a group"}},
        {paint({{"op", "\"density\""}, {"only_unpainted", "0"}}), {"key only_unpainted is 0", "true or false"}},
        {paint({{"only_unpaint", "true"}}), {"unknown key only_unpaint", "only_unpainted"}},
        {paint({{"path", ""}}), {"key path is missing"}},
        {paint({{"path", "[]"}}), {"key path is []", "at least one point"}},
        {paint({{"path", "[1,2,3]"}}), {"key path.0 is 1", "[x, y, z]"}},
        {paint({{"path", "[[1,2,3],[1,2]]"}}), {"key path.1 is [1,2]", "three numbers"}},
        {paint({{"path", "[[1,2,3],[1,2,3,4]]"}}), {"key path.1 is [1,2,3,4]"}},
        {paint({{"path", "[[1,2,\"3\"]]"}}), {"key path.0.2 is \"3\"; expected a finite number"}},
        {paint({{"path", "{\"x\":1}"}}), {"key path is {\"x\":1}"}},
        {paint({{"path", "[[0,0,0],[1e9,0,0]]"}}), {"key path", "1000000"}},
        {paint({{"path", "[[-1e308,0,0],[1.7e308,0,0]]"}}), {"key path", "1000000"}},
        {paint({{"colour", "1"}}), {"unknown key colour", "threshold"}},
        {R"({"op":"node"})", {"key at is missing"}},
        {R"({"op":"node","at":[1,2]})", {"key at is [1,2]", "three numbers, [x, y, z]"}},
        {R"({"op":"node","at":[1,2,1e13]})", {"key at.2 is 1", "from -1e+12 to 1e+12"}},
        {R"({"op":"node","at":[1,2,3],"radius":0})", {"key radius is 0", "above 0"}},
        {R"({"op":"node","at":[1,2,3],"group":256})", {"key group is 256"}},
        {R"({"op":"node","at":[1,2,3],"divides":-1})", {"key divides is -1"}},
        {R"({"op":"select"})", {"none of these keys is given: near, near_internode, node, internode"}},
        {R"({"op":"select","near":[1,2,3],"node":4})", {"keys near and node are both given"}},
        {R"({"op":"select","node":-1})", {"key node is -1"}},
        {R"({"op":"select","node":4294967296})", {"key node is 4294967296"}},
        {R"({"op":"select","node":4,"within":3})", {"key within is given with node"}},
        {R"({"op":"deselect","node":4})", {"unknown key node", "only op"}},
        {R"({"op":"link","to":4})", {"unknown key to"}},
        {R"({"op":"link"})", {"none of these keys is given: near, node"}},
        {R"({"op":"link","node":4,"within":3})", {"key within is given with node; expected it with near"}},
        {R"({"op":"link","near":[1,2,3],"within":0})", {"key within is 0", "above 0"}},
        {R"({"op":"select","internode":4,"within":3})", {"key within is given with internode"}},
        {R"({"op":"move","to":"here"})", {"key to is \"here\""}},
        {R"({"op":"group"})", {"key group is missing"}},
        {R"({"op":"radius"})", {"key radius is missing"}},
        {R"({"op":"radius","radius":null})", {"key radius is null"}},
        {R"({"op":"radius","radius":2,"of":"nodes"})", {"key of is given without group"}},
        {R"({"op":"radius","radius":2,"of":"all","group":3})", {"key of is \"all\"", R"("nodes", "internodes")"}},
        {R"({"op":"undo","count":0})", {"key count is 0", "from 1"}},
        {R"({"op":"undo","count":-1})", {"key count is -1"}},
        {R"({"op":"redo","count":"2"})", {"key count is \"2\""}},
        {R"({"op":"redo","times":2})", {"unknown key times", "count"}},
        {R"({"op":"save","path":"a.mask"})", {"unknown key path", "only op"}},
        {R"({"op":"expect","voxels_in_group":5})", {"key voxels_in_group is 5", "object"}},
        {R"({"op":"expect","voxels_in_group":{"256":1}})", {"key voxels_in_group.256", "0 ... 255"}},
        {R"({"op":"expect","voxels_in_group":{"03":1}})", {"key voxels_in_group.03"}},
        {R"({"op":"expect","voxels_in_group":{"":1}})", {"key voxels_in_group."}},
        {R"({"op":"expect","voxels_in_group":{"3":-1}})", {"key voxels_in_group.3 is -1"}},
        {R"({"op":"expect","nodes":1.5})", {"key nodes is 1.5"}},
        {R"({"op":"expect","internodes":[]})", {"key internodes is []"}},
        {R"({"op":"expect","voxels":1})", {"unknown key voxels"}},
        {R"({"op":"erase"})", {"key op is \"erase\"", R"("paint", "density", "node", "select")"}},
        {R"({"op":5})", {"key op is 5"}},
        {R"({"brush":"flood"})", {"key op is missing"}},
        {R"({"op":"undo","count":1,"count":2})", {"key count appears twice"}},
        {R"(["op","save"])", {"[\"op\",\"save\"]", "object"}},
        {R"("save")", {"\"save\"", "object"}},
        {R"({"op":"save")", {"is not JSON"}},
        {R"({"op":"save"} {"op":"save"})", {"is not JSON"}},
        {R"({"op":"save"} // done)", {"is not JSON"}},
        {"\xff\xfe", {"is not JSON"}},
        {"{\"op\":\"\xff\"}", {"is not JSON"}},
        // The parser treats a zero byte as the end and would miss the rest.
        {std::string("{\"op\":\"save\"}\0{\"op\":\"undo\"}", 27), {"is not JSON: byte 14 is zero"}},
        {R"({"op":"save","a":[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]})", {"nests"}},
    };
    for (const BadLine& bad : bad_lines) {
        CAPTURE(bad.line);
        const std::string message = refusal("{\"op\":\"save\"}\n\n" + bad.line + "\n{\"op\":\"save\"}\n");
        CAPTURE(message);
        CHECK(contains(message, "a.jsonl:3: "));
        for (const char* part : bad.parts) CHECK(contains(message, part));
        CHECK(message.find('\n') == std::string::npos);
    }
}

TEST_CASE("lines of tracing are read with every key")
{
    const auto node = op_of<NodeOp>(R"({"op":"node","at":[1,-2.5,3],"radius":4.5,"group":0})");
    CHECK(node.at == glm::dvec3(1, -2.5, 3));
    CHECK(node.radius_voxels == 4.5);
    CHECK(node.group == uint8_t{0});
    CHECK(!op_of<NodeOp>(R"({"op":"node","at":[1,2,3]})").group);
    CHECK(!op_of<NodeOp>(R"({"op":"node","at":[1,2,3]})").radius_voxels);

    const auto near = op_of<SelectOp>(R"({"op":"select","near":[1,2,3],"within":7})");
    CHECK(near.near == glm::dvec3(1, 2, 3));
    CHECK(near.within_voxels == 7.0);
    CHECK(!near.is_internode);
    CHECK(op_of<SelectOp>(R"({"op":"select","near_internode":[1,2,3]})").is_internode);
    CHECK(op_of<SelectOp>(R"({"op":"select","near_internode":[1,2,3],"within":4})").within_voxels == 4.0);
    CHECK(op_of<SelectOp>(R"({"op":"select","node":4294967295})").number == 4294967295u);
    CHECK(op_of<SelectOp>(R"({"op":"select","internode":8})").is_internode);
    op_of<SelectSegmentOp>(R"({"op":"select_segment"})");
    op_of<DeselectOp>(R"({"op":"deselect"})");
    op_of<DeleteOp>(R"({"op":"delete"})");

    CHECK(op_of<LinkOp>(R"({"op":"link","near":[4,5,6]})").near == glm::dvec3(4, 5, 6));
    CHECK(!op_of<LinkOp>(R"({"op":"link","near":[4,5,6]})").within_voxels);
    CHECK(op_of<LinkOp>(R"({"op":"link","near":[4,5,6],"within":2.5})").within_voxels == 2.5);
    CHECK(op_of<LinkOp>(R"({"op":"link","node":9})").node == 9u);
    CHECK(op_of<MoveOp>(R"({"op":"move","to":[7,8,9]})").to == glm::dvec3(7, 8, 9));
    CHECK(!op_of<MoveOp>(R"({"op":"move","to":[7,8,9]})").from);
    CHECK(op_of<MoveOp>(R"({"op":"move","to":[7,8,9],"from":[1,2,3]})").from == glm::dvec3(1, 2, 3));
    CHECK(op_of<GroupOp>(R"({"op":"group","group":200})").group == 200);

    const auto selected = op_of<RadiusOp>(R"({"op":"radius","radius":2})");
    CHECK(selected.of == RadiusOp::Of::selected);
    CHECK(selected.radius_voxels == 2.0);
    const auto nodes = op_of<RadiusOp>(R"({"op":"radius","radius":2,"group":5})");
    CHECK(nodes.of == RadiusOp::Of::nodes);
    CHECK(nodes.group == 5);
    const auto internodes = op_of<RadiusOp>(R"({"op":"radius","radius":null,"group":5,"of":"internodes"})");
    CHECK(internodes.of == RadiusOp::Of::internodes);
    CHECK(!internodes.radius_voxels);
}

TEST_CASE("a line of density is read with every key, and says little where defaults do")
{
    const auto op =
        op_of<PaintOp>(R"({"op":"density","brush":"speckle","region":"box","group":7,"threshold":90,"offset":-40.5,)"
                       R"("falloff":"distance","radius":6.5,"connectivity":26,"path":[[1,2,3],[4,5,6]]})");
    CHECK(op.brush == Brush::speckle);
    CHECK(op.region == RegionShape::box);
    CHECK(op.paints_group);
    CHECK(op.group == 7);
    CHECK((op.density == DensityBrush{-40.5, Falloff::distance}));
    CHECK(op.path.size() == 2);
    const auto little =
        op_of<PaintOp>(R"({"op":"density","brush":"flood","threshold":90,"radius":6,"path":[[1,2,3]]})");
    CHECK_FALSE(little.paints_group);
    CHECK((little.density == DensityBrush{std::nullopt, Falloff::flat}));
    const auto automatic = op_of<PaintOp>(
        R"({"op":"density","brush":"fill","threshold":90,"offset":"automatic","radius":6,"path":[[1,2,3]]})");
    CHECK((automatic.density == DensityBrush{std::nullopt, Falloff::flat}));
    CHECK_FALSE(op_of<PaintOp>(paint({})).density.has_value());
    const std::string line = R"({"op":"density","brush":"fill","threshold":90,"radius":6,"path":[[1,2,3]])";
    CHECK(contains(refusal(line + R"(,"offset":"much"})"),
                   "a.jsonl:1: key offset is \"much\"; expected a number or \"automatic\""));
    CHECK(contains(refusal(line + R"(,"falloff":"steep"})"),
                   "key falloff is \"steep\"; expected one of \"flat\", \"distance\""));
    CHECK(contains(refusal(line + R"(,"group":256})"), "key group is 256"));
    CHECK(contains(refusal(line + R"(,"amount":3})"), "unknown key amount"));
    CHECK(contains(refusal(paint({{"offset", "3"}})), "unknown key offset"));
}

TEST_CASE("a long value is shown in part, on one line")
{
    const std::string message = refusal(paint({{"brush", "\"" + std::string(100000, 'x') + "\""}}));
    CHECK(contains(message, "..."));
    CHECK(message.size() < 400);
}

TEST_CASE("a script that cannot be read is refused with its path")
{
    const TemporaryFolder folder;
    CHECK(contains(error_of([&] { read_script(folder.path / "missing.jsonl"); }), "missing.jsonl"));
    CHECK(contains(error_of([&] { read_script(folder.path); }), folder.path.string()));
}

TEST_CASE("lines of operations on groups are read with every key, and written again")
{
    const char* const lines[] = {
        R"({"op":"combine","group":3,"with":4,"how":"swap"})",
        R"({"op":"islands","group":3,"keep":"at_least","mm3":0.25,"connectivity":26,"within":[-1.5,70],"inside":0,)"
        R"("only_unpainted":true,"box":[-1,0,2,30,40,50]})",
        R"({"op":"islands","group":3,"keep":"at","at":[1,2.5,3],"split_from":10,"connectivity":6,)"
        R"("only_unpainted":false})",
        R"({"op":"fill_holes","group":255})"};
    for (const char* const text : lines) {
        CAPTURE(text);
        const std::vector<ScriptLine> script = script_of(text);
        const std::string written = line_of(script.at(0).op);
        CHECK(line_of(script_of(written).at(0).op) == written);
        for (const char* const key : {"with", "how", "mm3", "at", "split_from", "within", "inside", "box"}) {
            const std::string quoted = '"' + std::string(key) + '"';
            CHECK((std::string(text).find(quoted) != std::string::npos) == (written.find(quoted) != std::string::npos));
        }
    }
    const auto op = op_of<IslandsOp>(lines[1]);
    CHECK(op.limits.box == VoxelBox{{-1, 0, 2}, {30, 40, 50}});
    CHECK(op.limits.within == glm::dvec2(-1.5, 70));
    CHECK(op.limits.inside == 0);
    CHECK(op.limits.only_unpainted);
}
