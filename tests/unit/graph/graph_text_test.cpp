#include "engine/graph/graph_text.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using namespace shvr;
using Json = nlohmann::json;

namespace {

//  atlas* -> raycast -> color -> read back color         * imported
//            unused  -> scratch                          culled
struct Frame {
    FrameGraph graph;
    CompiledGraph compiled;

    Frame()
    {
        const Resource atlas = graph.import("atlas", {.id = 1, .desc = image_desc(Format::r16_unorm, {34, 34, 34})});
        Pass raycast = graph.compute("raycast_masked", "raycast \"fine\"");
        raycast.read("atlas", atlas);
        raycast.constant("SHADED", 1);
        raycast.dispatch({640, 480, 1}, {128, 128, 0});
        const Resource color =
            raycast.write("color", graph.create("color", image_desc(Format::rgba32_float, {640, 480, 1})));
        static_cast<void>(graph.fill(graph.create("scratch", buffer_desc(1000)), 0, "unused"));
        graph.read_back(color);
        compiled = graph.compile();
    }
};

bool holds(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

/// The line that declares a node.
std::string node(const std::string& dot, const std::string& name)
{
    const size_t begin = dot.find("    " + name + " [");
    return begin == std::string::npos ? "(none)" : dot.substr(begin, dot.find('\n', begin) - begin);
}

size_t count(const std::string& text, const std::string& part)
{
    size_t found = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

}  // namespace

TEST_CASE("Graphviz shows a pass with step, kernel, threads and barrier")
{
    const Frame frame;
    const std::string box = node(to_graphviz(frame.graph, frame.compiled), "pass0");
    INFO(box);
    CHECK(holds(box, "shape=box"));
    CHECK(holds(box, "0: raycast \\\"fine\\\""));
    CHECK(holds(box, "kernel raycast_masked"));
    CHECK(holds(box, "640 x 480 x 1 threads"));
    CHECK(holds(box, "barrier compute+transfer -> compute"));
    CHECK_FALSE(holds(box, "dashed"));
}

TEST_CASE("Graphviz shows what outlives the frame with a double line")
{
    const Frame frame;
    const std::string dot = to_graphviz(frame.graph, frame.compiled);
    CHECK(holds(node(dot, "resource0"), "shape=ellipse, peripheries=2"));
    CHECK(holds(node(dot, "resource0"), "r16_unorm 34 x 34 x 34, 76.8 KiB"));
    CHECK(holds(node(dot, "resource1"), "peripheries=1"));
    CHECK(holds(node(dot, "resource1"), "steps 0 to 1"));
}

TEST_CASE("Graphviz shows what was culled dashed and grey")
{
    const Frame frame;
    const std::string dot = to_graphviz(frame.graph, frame.compiled);
    CHECK(holds(node(dot, "pass1"), "unused (culled)"));
    CHECK(holds(node(dot, "pass1"), "style=dashed, color=gray60"));
    CHECK(holds(node(dot, "resource2"), "style=dashed, color=gray60"));
    CHECK(count(dot, "style=dashed") == 3);  // the pass, its resource and the arrow between them
}

TEST_CASE("Graphviz draws an arrow for every read and every write")
{
    const Frame frame;
    const std::string dot = to_graphviz(frame.graph, frame.compiled);
    CHECK(holds(dot, "resource0 -> pass0 [label=\"atlas\"]"));
    CHECK(holds(dot, "pass0 -> resource1 [label=\"color\"]"));
    CHECK(holds(dot, "resource1 -> pass2 [label=\"source\"]"));
    CHECK(count(dot, "label=") == 3 + 3 + 4);
}

TEST_CASE("JSON tells of every pass what it binds and what became of it")
{
    const Frame frame;
    const Json json = Json::parse(to_json_text(frame.graph, frame.compiled));
    REQUIRE(json["passes"].size() == 3);
    const Json& raycast = json["passes"][0];
    CHECK(raycast["name"] == "raycast \"fine\"");
    CHECK(raycast["kind"] == "compute");
    CHECK(raycast["kernel"] == "raycast_masked");
    CHECK(raycast["alive"] == true);
    CHECK(raycast["step"] == 0);
    CHECK(raycast["threads"] == Json::array({640, 480, 1}));
    CHECK(raycast["tile"] == Json::array({128, 128, 0}));
    CHECK(raycast["constants"] == Json{{"SHADED", 1}});
    CHECK(raycast["barrier"] == Json{{"from", "compute+transfer"}, {"to", "compute"}, {"memory", true}});
    CHECK(raycast["declared_at"].get<std::string>().starts_with("graph_text_test.cpp:"));
    CHECK(raycast["bindings"] ==
          Json::array({{{"name", "atlas"}, {"resource", "atlas"}, {"index", 0}, {"reads", true}, {"writes", false}},
                       {{"name", "color"}, {"resource", "color"}, {"index", 1}, {"reads", false}, {"writes", true}}}));
    CHECK(json["passes"][1]["alive"] == false);
    CHECK(json["passes"][1]["step"].is_null());
    CHECK(json["passes"][1]["barrier"].is_null());
    CHECK(json["passes"][2]["kind"] == "read back");
    CHECK(json["passes"][2]["step"] == 1);
}

TEST_CASE("JSON tells of every resource what it is and how long it lives")
{
    const Frame frame;
    const Json json = Json::parse(to_json_text(frame.graph, frame.compiled));
    REQUIRE(json["resources"].size() == 3);
    CHECK(json["resources"][0] == Json{{"name", "atlas"},
                                       {"kind", "image"},
                                       {"format", "r16_unorm"},
                                       {"texels", {34, 34, 34}},
                                       {"bytes", 34 * 34 * 34 * 2},
                                       {"imported", true},
                                       {"versions", 0},
                                       {"lifetime", {{"first_step", 0}, {"last_step", 0}}}});
    CHECK(json["resources"][1]["lifetime"] == Json{{"first_step", 0}, {"last_step", 1}});
    CHECK(json["resources"][2]["kind"] == "buffer");
    CHECK(json["resources"][2]["format"].is_null());
    CHECK(json["resources"][2]["versions"] == 1);
    CHECK(json["resources"][2]["lifetime"].is_null());
}

TEST_CASE("an empty graph is text too")
{
    const FrameGraph graph;
    CHECK(to_graphviz(graph, graph.compile()).starts_with("digraph frame {"));
    CHECK(Json::parse(to_json_text(graph, graph.compile())) ==
          Json{{"passes", Json::array()}, {"resources", Json::array()}});
}
