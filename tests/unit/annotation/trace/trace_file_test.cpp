#include "engine/annotation/trace/trace_file.h"

#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <set>

#include <doctest/doctest.h>

#include "engine/annotation/trace/trace_forms.h"
#include "tests/support/traces.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const TraceSpace SPACE{{40, 30, 20}, {0.5, 0.25, 1.5}, "um"};

/// Two trees, or with `loops` also a loop, with numbers that need all their digits.
TraceGraph random_trace(uint32_t seed, bool loops)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1e3, 1e3);
    std::vector<TraceNode> nodes;
    std::vector<TraceInternode> internodes;
    for (uint32_t i = 0; i < 200; ++i) {
        nodes.push_back({{uniform(random), uniform(random) * 1e-7, uniform(random) * 1e7},
                         std::abs(uniform(random)),
                         uint8_t(random() % 256)});
        const uint32_t first = i < 120 ? 0 : 120;
        // As in SWC: an internode has its outer node's group.
        if (i > first) internodes.push_back({first + uint32_t(random()) % (i - first), i, nodes.back().group});
    }
    if (loops) internodes.push_back({119, 3, 7});
    if (loops) internodes.push_back({130, 119, 9});
    return trace_of(nodes, internodes);
}

std::string content_of(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The trace without its numbers: sorted nodes and internodes.
std::pair<std::multiset<std::string>, std::multiset<std::string>> shape_of(const TraceGraph& trace)
{
    const auto text_of = [](const TraceNode& node) {
        return sentence(digits_of(node.position), " ", digits_of(node.radius), " ", int(node.group));
    };
    std::multiset<std::string> nodes, internodes;
    for (const auto& [number, node] : trace.nodes()) nodes.insert(text_of(node));
    for (const auto& [number, internode] : trace.internodes()) {
        const std::string a = text_of(trace.node(internode.a)), b = text_of(trace.node(internode.b));
        internodes.insert(sentence(std::min(a, b), " - ", std::max(a, b), " ", int(internode.group)));
    }
    return {nodes, internodes};
}

/// The refusal without the folder's name.
std::string refusal(const std::string& name, const std::string& text, std::optional<TraceSpace> space = {})
{
    const TemporaryFolder folder;
    const auto path = folder.write(name, text);
    const std::string error = error_of([&] { load_trace(path, space); });
    const std::string prefix = path.parent_path().string() + "/";
    return error.starts_with(prefix) ? error.substr(prefix.size()) : error;
}

}  // namespace

TEST_CASE("the thesis's text is written byte for byte, with indices of the nodes that are left")
{
    TraceReader reader("test");
    reader.add_node("", {{1, 2.5, -3}, 4, 5}, 2);
    reader.add_node("", {{0.1, 1e-9, 1e21}, 0.25, 255}, 7);
    reader.add_internode("", {7, 2, 9});
    const std::string text = write_trace_text({reader.trace, SPACE});
    CHECK(text.starts_with(
        "# SHVR trace\n# positions are voxels times spacing, in um, from the outer corner of voxel 0"));
    CHECK(contains(text, "\n# space volume\n# unit um\n# spacing 0.5 0.25 1.5\n# size 40 30 20\n"));
    CHECK(text.substr(text.find("-v")) == "-v 1, 2.5, -3, 5, 4\n-v 0.1, 1e-09, 1e+21, 255, 0.25\n-l 1, 0, 9\n");
}

TEST_CASE("the thesis's text is read back, also with other spacing and links before nodes")
{
    const TemporaryFolder folder;
    const TraceGraph trace = random_trace(1, true);
    save_trace(folder.path / "a.txt", trace, SPACE);
    CHECK((load_trace(folder.path / "a.txt", SPACE).trace == trace));

    const auto odd = folder.write("b.txt", "-l 0,1,3\r\n\r\n  -v 1,2 ,3,4,5\r\n-v\t6,7,8,9,0.5");
    const TraceGraph read = load_trace(odd, {}).trace;
    CHECK((read == trace_of({{{1, 2, 3}, 5, 4}, {{6, 7, 8}, 0.5, 9}}, {{0, 1, 3}})));
}

TEST_CASE("SWC is written in the standard order, with the volume in comments")
{
    const TemporaryFolder folder;
    // 2 is the middle of three; it was drawn last.
    const TraceGraph trace = trace_of({{{0, 0, 0}, 1, 1}, {{2, 0, 0}, 1, 2}, {{1, 0, 0}, 1.5, 3}, {{9, 9, 9}, 2, 4}},
                                      {{0, 2, 3}, {1, 2, 3}});
    save_trace(folder.path / "a.swc", trace, SPACE);
    CHECK(content_of(folder.path / "a.swc") ==
          "# SHVR trace\n# positions are voxels times spacing, in um, from the outer corner of voxel 0: the centre of "
          "voxel "
          "i is at (i + 1/2) spacing\n# space volume\n# unit um\n# spacing 0.5 0.25 1.5\n# size 40 30 20\n"
          "# n type x y z radius parent; the type is the colour group\n"
          "1 1 0 0 0 1 -1\n2 3 1 0 0 1.5 1\n3 2 2 0 0 1 2\n4 4 9 9 9 2 -1\n");
}

TEST_CASE("SWC brings trees back")
{
    const TemporaryFolder folder;
    for (uint32_t seed = 1; seed < 6; ++seed) {
        const TraceGraph trace = random_trace(seed, false);
        CHECK(save_trace(folder.path / "a.swc", trace, SPACE).empty());
        const TraceFile read = load_trace(folder.path / "a.swc", SPACE);
        CHECK((shape_of(read.trace) == shape_of(trace)));
        CHECK((read.space == SPACE));
    }
}

TEST_CASE("a loop is refused by SWC and RSML, or broken where the last internode closed it")
{
    const TemporaryFolder folder;
    const TraceGraph ring =
        trace_of({{{0, 0, 0}, 1, 1}, {{1, 0, 0}, 1, 1}, {{1, 1, 0}, 1, 1}}, {{0, 1, 1}, {1, 2, 1}, {2, 0, 1}});
    for (const char* name : {"a.swc", "a.rsml"}) {
        CAPTURE(name);
        const auto path = folder.path / name;
        const std::string error = error_of([&] { save_trace(path, ring, SPACE); });
        CHECK(contains(error, "the trace has 1 loops, one of them closed by internode 2 between nodes 2 and 0, and "));
        CHECK(!std::filesystem::exists(path));
        const std::vector<std::string> notes = save_trace(path, ring, SPACE, Loops::break_open);
        REQUIRE(notes.size() == 1);
        CHECK(contains(notes[0], "internode 2 between nodes 2 and 0 is left out"));
    }
    CHECK(contains(content_of(folder.path / "a.swc"), "# internode 2 between nodes 2 and 0 is left out"));
    CHECK((load_trace(folder.path / "a.swc", SPACE).trace ==
           trace_of({{{0, 0, 0}, 1, 1}, {{1, 0, 0}, 1, 1}, {{1, 1, 0}, 1, 1}}, {{0, 1, 1}, {1, 2, 1}})));

    const TraceGraph many = random_trace(3, true);
    CHECK(save_trace(folder.path / "b.swc", many, SPACE, Loops::break_open).size() == 1);
    const TraceGraph opened = load_trace(folder.path / "b.swc", SPACE).trace;
    CHECK(opened.nodes().size() == many.nodes().size());
    CHECK(opened.internodes().size() == many.internodes().size() - 1);
}

TEST_CASE("GraphML keeps everything: loops, numbers, sizes, what comes next, and the volume")
{
    const TemporaryFolder folder;
    TraceGraph trace = random_trace(1, true);
    trace.apply(TraceSizeChange{3, {}, 1.75}, Direction::forwards);
    trace.apply(TraceSizeChange{255, {}, 0.1}, Direction::forwards);
    trace.apply(TraceInternodeChange{5, trace.internode(5), {}}, Direction::forwards);
    trace.reserve_numbers(1000, uint64_t{1} << 32);
    save_trace(folder.path / "a.graphml", trace, SPACE);
    const TraceFile read = load_trace(folder.path / "a.graphml", SPACE);
    CHECK((read.trace == trace));
    CHECK(read.trace.next_node() == 1000);
    CHECK(read.trace.next_internode() == uint64_t{1} << 32);
    CHECK((read.space == SPACE));
    save_trace(folder.path / "b.graphml", read.trace, SPACE);
    CHECK(content_of(folder.path / "a.graphml") == content_of(folder.path / "b.graphml"));
    save_trace(folder.path / "empty.graphml", {}, SPACE);
    CHECK(load_trace(folder.path / "empty.graphml", SPACE).trace.nodes().empty());
}

TEST_CASE("GraphML of other programs is read: any ids, keys by their names, what is missing as usual")
{
    const TemporaryFolder folder;
    const auto path = folder.write("a.graphml", R"(<?xml version='1.0' encoding='utf-8'?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns"><key id="d3" for="edge" attr.name="group" attr.type="long"/>
<key id="d2" for="node" attr.name="z" attr.type="double"/><key id="d1" for="node" attr.name="y" attr.type="double"/>
<key id="d0" for="node" attr.name="x" attr.type="double"/>
<graph edgedefault="undirected"><edge source="b" target="7"><data key="d3">4</data></edge>
<node id="7"><data key="d0">1.5</data><data key="d1"> 2 </data><data key="d2">3</data></node>
<node id="b"><data key="d0">4</data><data key="d1">5</data><data key="d2">6</data><data key="other">!</data></node>
</graph></graphml>)");
    const TraceFile read = load_trace(path, SPACE);
    CHECK((read.trace == trace_of({{{1.5, 2, 3}, 1, 1}, {{4, 5, 6}, 1, 1}}, {{1, 0, 4}})));
    CHECK(!read.space);
}

TEST_CASE("RSML: the longest way is the first axis, branches are roots below it, in pixels along x")
{
    // 0 - 1 - 2 - 3 along x, and 4 off 1.
    const TraceGraph trace =
        trace_of({{{0, 0, 0}, 1, 1}, {{1, 0, 0}, 1, 1}, {{2, 0, 0}, 1, 1}, {{3, 0, 0}, 0.5, 2}, {{1, 1.5, 0}, 1, 3}},
                 {{0, 1, 1}, {1, 4, 1}, {1, 2, 1}, {2, 3, 1}});
    std::vector<std::string> notes;
    const std::string text = write_trace_rsml({trace, SPACE}, Loops::refuse, notes);
    CHECK(contains(text, "<unit>um</unit>\n  <resolution>2</resolution>"));
    std::string plain;  // without the white space between elements
    for (size_t at = 0; at < text.size(); at = text.find_first_not_of(" \n", at)) {
        const size_t end = std::min(text.find('\n', at), text.size());
        plain += text.substr(at, end - at);
        at = end;
    }
    const size_t main = plain.find("<root ID=\"1\">"), side = plain.find("<root ID=\"2\">");
    REQUIRE(main < side);
    REQUIRE(side < plain.size());
    const std::string main_text = plain.substr(main, side - main), side_text = plain.substr(side);
    CHECK(contains(main_text,
                   "<polyline><point x=\"0\" y=\"0\" z=\"0\" /><point x=\"2\" y=\"0\" z=\"0\" />"
                   "<point x=\"4\" y=\"0\" z=\"0\" /><point x=\"6\" y=\"0\" z=\"0\" /></polyline>"));
    CHECK(
        contains(side_text, "<polyline><point x=\"2\" y=\"0\" z=\"0\" /><point x=\"2\" y=\"3\" z=\"0\" /></polyline>"));
    CHECK(contains(main_text, "<sample value=\"4\" /><sample value=\"2\" /></function>"));  // 0.5 um is a pixel
    CHECK(side_text.ends_with("</root></root></plant></scene></rsml>"));                    // one in the other
}

TEST_CASE("RSML is read back: trees, places, radii and groups of nodes")
{
    const TemporaryFolder folder;
    for (uint32_t seed = 0; seed < 30; ++seed) {
        CAPTURE(seed);
        const TraceGraph trace = random_trace(seed, false);
        const auto path = folder.path / "a.rsml";
        const std::vector<std::string> notes = save_trace(path, trace, SPACE, Loops::break_open);
        const TraceGraph read = load_trace(path, SPACE).trace;
        REQUIRE(read.nodes().size() == trace.nodes().size());
        REQUIRE(read.internodes().size() == trace.internodes().size() - notes.size());
        // Numbers are new; nodes are matched by position.
        std::map<uint32_t, uint32_t> old_of;
        for (const auto& [number, node] : read.nodes())
            for (const auto& [old, before] : trace.nodes()) {
                if (std::abs(node.position.x - before.position.x) > 1e-9) continue;
                old_of[number] = old;
                CHECK(node.position.y == doctest::Approx(before.position.y));
                CHECK(node.position.z == doctest::Approx(before.position.z));
                CHECK(node.radius == doctest::Approx(before.radius));
                CHECK(node.group == before.group);
            }
        CHECK(old_of.size() == read.nodes().size());
        for (const auto& [number, internode] : read.internodes())
            CHECK(trace.internode_between(old_of.at(internode.a), old_of.at(internode.b)).has_value());
    }
}

TEST_CASE("RSML of other programs is read, whatever else is in it")
{
    const TemporaryFolder folder;
    const auto path = folder.write("a.rsml", R"(<?xml version="1.0" encoding="UTF-8"?>
<rsml xmlns:po="http://www.plantontology.org/xml-dtd/po.dtd"><metadata><version>1</version><unit>micron</unit>
<resolution>4</resolution><software>smartroot</software><image><name>x.tif</name></image></metadata>
<scene><plant ID="p" label="oat"><annotations/><root ID="1" po:accession="PO:0020127"><properties><angle>3</angle>
</properties><geometry><rootnavspline/><polyline><point x="4" y="8"/><point x="8" y="8" time="2"/><point x="12" y="8"/>
</polyline></geometry><functions><function name="orientation" domain="polyline"><sample>1</sample></function>
<function name="diameter" domain="length"><sample>9</sample></function>
<function name="diameter" domain="polyline"><sample>8</sample><sample value="4"/><sample> 2 </sample></function></functions>
<root ID="1.1"><geometry><polyline><point x="8" y="8"/><point x="8" y="12"/></polyline></geometry></root>
<root ID="1.2"><geometry><polyline><point x="12" y="12"/><point x="12" y="16"/></polyline></geometry></root>
</root></plant></scene></rsml>)");
    const TraceFile read = load_trace(path, SPACE);
    const TraceGraph expected = trace_of({{{1, 2, 0}, 1, 1},
                                          {{2, 2, 0}, 0.5, 1},
                                          {{3, 2, 0}, 0.25, 1},
                                          {{2, 3, 0}, 0.25, 1},  // begins at its parent's node
                                          {{3, 3, 0}, 0.25, 1},  // begins beside it
                                          {{3, 4, 0}, 0.25, 1}},
                                         {{0, 1, 1}, {1, 2, 1}, {1, 3, 1}, {2, 4, 1}, {4, 5, 1}});
    CHECK((shape_of(read.trace) == shape_of(expected)));
    CHECK(!read.space);
}

TEST_CASE("RSML in another unit of length is converted to the volume's, by its resolution")
{
    const TemporaryFolder folder;
    const auto read = [&](const std::string& metadata, const std::optional<TraceSpace>& space) {
        const auto path = folder.write(
            "a.rsml", "<rsml><metadata>" + metadata +
                          "</metadata><scene><plant><root ID='1'><geometry><polyline><point x='10' y='20' z='-5'/>"
                          "</polyline></geometry><functions><function name='diameter' domain='polyline'>"
                          "<sample value='4'/></function></functions></root></plant></scene></rsml>");
        const TraceGraph trace = load_trace(path, space).trace;
        return trace.node(0);
    };
    /// One pixel is `pixel` units of the volume.
    const auto is_scaled = [](const TraceNode& node, double pixel) {
        const glm::dvec3 expected = pixel * glm::dvec3(10, 20, -5);
        return glm::length(node.position - expected) <= 1e-12 * glm::length(expected) &&
               std::abs(node.radius - 2.0 * pixel) <= 1e-12 * pixel;
    };
    const auto unit = [](const char* name) { return sentence("<unit>", name, "</unit>"); };
    const std::string resolution = "<resolution>4</resolution>";
    CHECK(is_scaled(read(unit("um") + resolution, SPACE), 0.25));
    CHECK(is_scaled(read(unit("mm") + resolution, SPACE), 250.0));
    CHECK(is_scaled(read(unit("centimetre") + resolution, SPACE), 2500.0));
    CHECK(is_scaled(read(unit("nm") + resolution, SPACE), 0.25e-3));
    CHECK(is_scaled(read(unit("inch") + "<resolution>300</resolution>", SPACE), 25400.0 / 300.0));
    CHECK(is_scaled(read(unit("m"), SPACE), 1e6));
    const TraceSpace in_mm{{40, 30, 20}, {0.5, 0.25, 1.5}, "mm"};
    CHECK(is_scaled(read(unit("um") + resolution, in_mm), 0.25e-3));
    CHECK(is_scaled(read(unit("inch") + resolution, in_mm), 25.4 / 4.0));
    // Pixels are voxels along x, and so are numbers without a stated unit; a resolution without a unit uses the
    // volume's.
    for (const char* pixel : {"pixel", "Pixels", "px"}) CHECK(is_scaled(read(unit(pixel), SPACE), 0.5));
    CHECK(is_scaled(read("", SPACE), 0.5));
    CHECK(is_scaled(read(unit("pixel") + "<resolution>2</resolution>", SPACE), 0.25));
    CHECK(is_scaled(read(resolution, SPACE), 0.25));
    // Without a volume nothing is converted.
    CHECK(is_scaled(read(unit("mm") + resolution, {}), 0.25));
    CHECK(is_scaled(read(unit("pixel"), {}), 1.0));
}

TEST_CASE("RSML that is none is refused in words")
{
    const TemporaryFolder folder;
    const auto told = [&](const std::string& text) {
        const auto path = folder.write("a.rsml", text);
        const std::string error = error_of([&] { load_trace(path, {}); });
        CHECK(contains(error, "a.rsml"));
        return error;
    };
    const auto root = [](const std::string& inside) {
        return "<rsml><metadata/><scene><plant><root ID='7'>" + inside + "</root></plant></scene></rsml>";
    };
    CHECK(contains(told(""), "cannot be read as RSML"));
    CHECK(contains(told("<graphml/>"), "it has no element rsml"));
    CHECK(contains(told("<rsml/>"), "has no element scene"));
    CHECK(contains(told(root("")), "root \"7\": has no geometry with a polyline of points"));
    CHECK(contains(told(root("<geometry><polyline><point x='1'/></polyline></geometry>")), "root \"7\": y is \"\""));
    CHECK(contains(told(root("<geometry><polyline><point x='nan' y='1'/></polyline></geometry>")), "x is \"nan\""));
    CHECK(contains(told(root("<properties><group>256</group></properties><geometry><polyline><point x='1' y='1'/>"
                             "</polyline></geometry>")),
                   "group is \"256\""));
    for (const char* resolution : {"0", "-1", "inf", "x", "1e-300"})
        CHECK(contains(
            told("<rsml><metadata><resolution>" + std::string(resolution) + "</resolution></metadata><scene/></rsml>"),
            "metadata: resolution is \"" + std::string(resolution) + "\""));
    // A unit that is not a length, and a volume whose unit is not a length.
    auto path = folder.write("a.rsml", "<rsml><metadata><unit>furlong</unit></metadata><scene/></rsml>");
    CHECK(contains(error_of([&] { load_trace(path, SPACE); }), "is in the unit \"furlong\"; expected \"um\""));
    path = folder.write("a.rsml", "<rsml><metadata><unit>cm</unit></metadata><scene/></rsml>");
    CHECK(contains(error_of([&] { load_trace(path, TraceSpace{}); }), "is in the unit \"cm\"; expected \"voxel\""));
    // Nested as deep as a file can be.
    std::string deep = "<rsml><scene><plant>", end;
    for (int i = 0; i < 100'000; ++i) deep += "<root><geometry><polyline><point x='1' y='1'/></polyline></geometry>";
    for (int i = 0; i < 100'000; ++i) end += "</root>";
    CHECK(load_trace(folder.write("a.rsml", deep + end + "</plant></scene></rsml>"), {}).trace.nodes().size() == 1);
}

TEST_CASE("a trace of another volume is refused with both named")
{
    const TemporaryFolder folder;
    for (const char* name : {"a.graphml", "a.swc"}) {
        CAPTURE(name);
        save_trace(folder.path / name, random_trace(1, false), SPACE);
        const auto with = [&](auto change) {
            TraceSpace other = SPACE;
            change(other);
            return error_of([&] { load_trace(folder.path / name, other); });
        };
        CHECK(contains(with([](TraceSpace& s) { s.size.y = 31; }),
                       ": is of a volume of 40 30 20 voxels; expected 40 31 20, the size of this one"));
        CHECK(contains(with([](TraceSpace& s) { s.spacing.z = 1.6; }),
                       ": is of a volume with voxels of 0.5 x 0.25 x 1.5 \u00b5m; expected 0.5 x 0.25 x 1.6 \u00b5m, "
                       "the spacing of this one"));
        CHECK(contains(with([](TraceSpace& s) { s.unit = "mm"; }), ": is of a volume with voxels of"));
        CHECK(contains(with([](TraceSpace& s) { s.unit = "furlong"; }), ": is in the unit \"um\"; expected"));
        CHECK(with([](TraceSpace& s) { s.spacing.z *= 1.0 + 1e-9; }).empty());
    }
}

TEST_CASE("hostile text is refused in one sentence")
{
    const std::string node = "-v 1, 2, 3, 4, 5\n";
    CHECK(refusal("a.txt", "hello") == "a.txt:1: is \"hello\"; expected a line that begins with -v or -l");
    CHECK(refusal("a.txt", "-v 1, 2, 3, 4") == "a.txt:1: is \"-v 1, 2, 3, 4\"; expected -v x, y, z, group, radius");
    CHECK(refusal("a.txt", node + "-v 1, x, 3, 4, 5") == "a.txt:2: y is \"x\"; expected a number from -1e15 to 1e15");
    CHECK(refusal("a.txt", "-v 1, 2, nan, 4, 5") == "a.txt:1: z is \"nan\"; expected a number from -1e15 to 1e15");
    CHECK(refusal("a.txt", "-v 1e16, 2, 3, 4, 5") == "a.txt:1: x is \"1e16\"; expected a number from -1e15 to 1e15");
    CHECK(refusal("a.txt", "-v 1, 2, 3, 256, 5") == "a.txt:1: group is \"256\"; expected a whole number from 0 to 255");
    CHECK(refusal("a.txt", "-v 1, 2, 3, 4, -5") == "a.txt:1: radius is \"-5\"; expected a number from 0 to 1e15");
    CHECK(refusal("a.txt", node + "-l 0, 1, 1") ==
          "a.txt:2: node index is \"1\"; expected a whole number from 0, below 1, the number of nodes in the file");
    CHECK(refusal("a.txt", node + "-l 0, 0, 1") == "a.txt:2: joins node 0 with itself; expected two different nodes");
    CHECK(refusal("a.txt", node + node + "-l 0, 1, 1\n-l 1, 0, 2") ==
          "a.txt:4: joins nodes 1 and 0 a second time; expected each link once");
    CHECK(refusal("a.doc", node) == "a.doc: has the extension \".doc\"; expected .graphml, .txt, .swc or .rsml");
}

// Kind (Traces): SWC with odd lines
TEST_CASE("odd lines of SWC are read past and named, a kind each")
{
    const auto read = [](const std::string& text, size_t nodes, size_t internodes,
                         std::optional<TraceSpace> space = {}) {
        const TemporaryFolder folder;
        const auto path = folder.write("a.swc", text);
        const TraceFile file = load_trace(path, space);
        CHECK(file.trace.nodes().size() == nodes);
        CHECK(file.trace.internodes().size() == internodes);
        std::string all;
        for (const std::string& warning : file.warnings)
            all += (all.empty() ? "" : "|") + warning.substr(path.parent_path().string().size() + 1);
        return all;
    };
    const std::string two = "1 1 0 0 0 1 -1\n2 1 1 0 0 1 1\n";
    CHECK(read(two, 2, 1).empty());
    CHECK(read("\xef\xbb\xbf" + two, 2, 1).empty());  // a byte order mark
    CHECK(read(two + "2 1 5 0 0 1 1\n", 2, 1) ==
          "a.swc:3: sample 2 is defined twice; expected each number once; it is left out");
    CHECK(read(two + "3 1 5 0 0 1 9\n4 1 6 0 0 1 8\n", 4, 1) ==
          "a.swc:3: parent is 9; expected -1 or a sample of the file; the sample is taken as a root, and so on in 1 "
          "more places");
    CHECK(read("1 1 0 0 0 1 0\n2 1 1 0 0 1 1\n", 2, 1) ==
          "a.swc:1: parent is 0; expected -1 or a sample of the file; the sample is taken as a root");
    CHECK(read(two + "3 274 5 0 0 1 2\n", 3, 2) ==
          "a.swc:3: group is \"274\"; expected a whole number from 0 to 255; group 1 is taken");
    CHECK(read("1.0 1.0 0 0 0 1 -1.0\n2.0 3.0 1 0 0 1 1.0\n", 2, 1) ==
          "a.swc:1: n is \"1.0\"; expected a number without a fraction; it is taken as one, and so on in 3 more places"
          "|a.swc:1: group is \"1.0\"; expected a whole number from 0 to 255; it is taken as one, and so on in 1 more "
          "places");
    CHECK(read(two + "3 1 nan 0 0 1 2\n4 1 5\n", 2, 1) ==
          "a.swc:3: x is \"nan\"; expected a number from -1e15 to 1e15; it is left out"
          "|a.swc:4: is \"4 1 5\"; expected n type x y z radius parent; it is left out");
    CHECK(read("1 1 0 0 0 1 1\n", 1, 0) ==
          "a.swc:1: joins node 0 with itself; expected two different nodes; it is left out");
    TraceSpace in_mm = SPACE;
    in_mm.unit = "mm";
    CHECK(
        contains(read(two, 2, 1, in_mm), "a.swc: states no unit; its lengths are taken in mm, the unit of the volume"));
    CHECK(read(two, 2, 1, SPACE).empty());
}

// Kind (Traces): a trace in another unit of length than the volume
TEST_CASE("a trace in another unit of length is converted")
{
    const TemporaryFolder folder;
    const auto path = folder.write("a.swc", "# unit um\n1 1 1000 500 0 20 -1\n");
    TraceSpace in_mm = SPACE;
    in_mm.unit = "mm";
    const TraceFile file = load_trace(path, in_mm);
    CHECK(file.trace.node(0).position == glm::dvec3(1.0, 0.5, 0.0));
    CHECK(file.trace.node(0).radius == 0.02);
    REQUIRE(file.warnings.size() == 1);
    CHECK(contains(file.warnings[0], "lengths were converted from um to mm, the unit of the volume"));
}

// Kind (Traces): GraphML with odd elements and defaults
TEST_CASE("odd elements of GraphML are read past, and its defaults taken")
{
    const TemporaryFolder folder;
    const auto data = [](const char* key, const char* value) {
        return sentence("<data key=\"", key, "\">", value, "</data>");
    };
    const std::string at = data("x", "1") + data("y", "2") + data("z", "3");
    const auto path = folder.write(
        "a.graphml",
        "<graphml><key id=\"x\" for=\"node\"/><key id=\"y\"/><key id=\"z\"/>"
        "<key id=\"r\" for=\"node\" attr.name=\"radius\"><default>2.5</default></key>"
        "<key id=\"g\" for=\"all\" attr.name=\"group\"><default>5.0</default></key><graph>"
        "<node id=\"a\">" +
            at + "</node><node id=\"b\">" + at + data("r", "1") + data("g", "300") + "</node><node id=\"b\">" + at +
            "</node><node id=\"c\"/><hyperedge/>"
            "<edge source=\"a\" target=\"b\"/><edge source=\"b\" target=\"a\"/>"
            "<edge source=\"a\" target=\"a\"/><edge source=\"a\" target=\"c\"/></graph></graphml>");
    const TraceFile file = load_trace(path, {});
    REQUIRE(file.trace.nodes().size() == 2);
    CHECK(file.trace.node(0).radius == 2.5);
    CHECK(file.trace.node(0).group == 5);
    CHECK(file.trace.node(1).radius == 1.0);
    CHECK(file.trace.node(1).group == 1);
    REQUIRE(file.trace.internodes().size() == 1);
    CHECK(file.trace.internode(0).group == 5);
    const std::string parts[] = {"holds a hyperedge",
                                 "group is \"300\"; expected a whole number from 0 to 255; group 1",
                                 "node \"b\": is defined twice",
                                 "node \"c\": has no data \"x\"",
                                 "a second time; expected each link once; it is left out",
                                 "with itself; expected two different nodes; it is left out",
                                 "node \"c\" does not exist"};
    REQUIRE(file.warnings.size() == std::size(parts));
    for (size_t i = 0; i < std::size(parts); ++i) CHECK(contains(file.warnings[i], parts[i]));
}

// Kind (Traces): RSML with functions over the length
TEST_CASE("functions of RSML over the length and uniform ones give the points their radius")
{
    const TemporaryFolder folder;
    const auto radii = [&](const std::string& function) {
        const auto path = folder.write(
            "a.rsml",
            "<rsml><metadata><unit>um</unit><resolution>2</resolution></metadata><scene><plant><root ID='1'>"
            "<geometry><polyline><point x='10' y='20'/><point x='10' y='25'/><point x='10' y='40'/>"
            "</polyline></geometry><functions>" +
                function + "</functions></root></plant></scene></rsml>");
        const TraceFile file = load_trace(path, SPACE);
        std::vector<double> found;
        for (const auto& [number, node] : file.trace.nodes()) found.push_back(node.radius);
        for (const std::string& warning : file.warnings) CHECK(contains(warning, "function \"diameter\" has"));
        CHECK(file.warnings.size() == (contains(function, "odd") ? 1 : 0));
        return found;
    };
    const auto function = [](const char* domain, const char* samples) {
        return sentence("<function name='diameter' domain='", domain, "'>", samples, "</function>");
    };
    using Radii = std::vector<double>;
    const char* const two = "<sample position='0' value='4'/><sample position='20' value='2'/>";
    CHECK(radii(function("length", two)) == Radii{1.0, 0.875, 0.5});
    CHECK(radii(function("uniform", two)) == Radii{1.0, 0.875, 0.5});
    CHECK(radii(function("uniform", "<sample value='4'/><sample value='4'/><sample>2</sample>")) ==
          Radii{1.0, 1.0, 0.5});
    CHECK(radii(function("length", "<sample position='5' value='4'/>")) == Radii{1.0, 1.0, 1.0});
    CHECK(radii(function("length", "<sample value='4' odd='1'/>")) == Radii{0.5, 0.5, 0.5});
    CHECK(radii(function("polyline", "<sample value='4' odd='1'/>")) == Radii{0.5, 0.5, 0.5});
}

TEST_CASE("hostile SWC is refused in one sentence")
{
    CHECK(refusal("a.swc", "1 1 0 0 0 1") ==
          "a.swc:1: is \"1 1 0 0 0 1\"; expected n type x y z radius parent; it is left out; no node is left");
    CHECK(contains(refusal("a.swc", "-1 1 0 0 0 1 -1"),
                   "a.swc:1: n is \"-1\"; expected a whole number from 0 to 2147483647"));
    CHECK(contains(refusal("a.swc", "1 1 0 0 0 1 -2"),
                   "a.swc:1: parent is \"-2\"; expected -1 or the number of a sample"));
    CHECK(contains(refusal("a.swc", "1 1 0 0 0 1 3\n2 1 1 0 0 1 1\n3 1 1 1 0 1 2"), "a.swc: the trace has 1 loops"));
    CHECK(refusal("a.swc", "# SCALE 2 2 1\n") ==
          "a.swc:1: SCALE is \"2 2 1\"; expected 1 1 1: positions in the volume's unit");
    CHECK(refusal("a.swc", "# spacing 1 0 1\n") == "a.swc:1: spacing is \"1 0 1\"; expected three numbers above 0");
    CHECK(refusal("a.swc", "# size 1 x 1\n") ==
          "a.swc:1: size is \"1 x 1\"; expected three whole numbers from 1 to 1048576");
    CHECK(refusal("a.swc", "3 1 0 0 0 1 2\n2 1 1 1 1 1 -1\n").empty());  // a child before its parent
}

TEST_CASE("hostile GraphML is refused in one sentence")
{
    const auto graph = [](const std::string& inside) {
        return "<graphml><key id=\"x\" for=\"node\"/><key id=\"y\"/><key id=\"z\"/><key id=\"group\"/><key "
               "id=\"size\"/>"
               "<key id=\"next_node\"/><key id=\"internode_radii\"/><graph>" +
               inside + "</graph></graphml>";
    };
    const auto node = [](const std::string& id, const std::string& x = "1") {
        return "<node id=\"" + id + "\"><data key=\"x\">" + x +
               "</data><data key=\"y\">2</data><data key=\"z\">3</data></node>";
    };
    CHECK(refusal("a.graphml", graph(node("n0") + node("n1") + "<edge source=\"n0\" target=\"n1\"/>")).empty());
    CHECK(contains(refusal("a.graphml", "<graphml><graph>"), "a.graphml: cannot be read as GraphML: "));
    CHECK(contains(refusal("a.graphml", "<svg/>"), "it has no element graphml"));
    CHECK(refusal("a.graphml", "<graphml/>") == "a.graphml: has no element graph; expected one");
    CHECK(refusal("a.graphml", graph("<node id=\"n0\"/>")) ==
          "a.graphml: node \"n0\": has no data \"x\"; expected x, y and z; it is left out; no node is left");
    CHECK(contains(refusal("a.graphml", graph(node("n0", "inf"))),
                   "a.graphml: node \"n0\": x is \"inf\"; expected a number from -1e15 to 1e15"));
    CHECK(contains(refusal("a.graphml", graph("<edge id=\"e\" source=\"n0\" target=\"n1\"/>")),
                   "a.graphml: edge \"e\" from \"n0\" to \"n1\": node \"n0\" does not exist; expected the id of a "
                   "node of the file"));
    CHECK(contains(refusal("a.graphml", graph("<hyperedge/>")), "holds a hyperedge"));
    CHECK(contains(refusal("a.graphml", graph("<data key=\"next_node\">4294967297</data>")),
                   "graph: next_node is \"4294967297\""));
    CHECK(contains(refusal("a.graphml", graph("<data key=\"size\">1 2 1048577</data>")), "graph: size is"));
    CHECK(contains(refusal("a.graphml", graph("<data key=\"internode_radii\">1=2 1=3</data>")), "group 1 twice"));
    CHECK(contains(refusal("a.graphml", graph("<data key=\"internode_radii\">1</data>")), "expected group=radius"));
    // If one id is not a number, no id is read as one.
    const TemporaryFolder folder;
    const auto mixed = folder.write("b.graphml", graph(node("n5") + node("b")));
    CHECK(load_trace(mixed, {}).trace.nodes().begin()->first == 0);
    // The largest possible number leaves none for new nodes.
    CHECK(refusal("a.graphml", graph(node("n4294967295"))).empty());
}

namespace {

/// Turned by a right angle about z and far from 0, in one of the frames that a file may name, or in none.
TraceSpace placed(const char* frame)
{
    TraceSpace space = SPACE;
    space.directions = glm::dmat3(glm::dvec3(0, -1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1));
    space.origin = {-1234.5, 0.1, 98765.4321};
    space.frame = frame;
    return space;
}

double farthest_apart(const TraceGraph& a, const TraceGraph& b)
{
    double most = 0.0;
    REQUIRE(a.nodes().size() == b.nodes().size());
    for (auto of_a = a.nodes().begin(), of_b = b.nodes().begin(); of_a != a.nodes().end(); ++of_a, ++of_b)
        most = std::max(most, glm::length(of_a->second.position - of_b->second.position));
    return most;
}

}  // namespace

TEST_CASE("a trace in physical space lies where the volume's file says, says so, and is read back into volume space")
{
    const TemporaryFolder folder;
    const std::vector<TraceNode> nodes{{{0.25, 0.125, 0.75}, 2, 1}, {{10.1, 3.3, 15.7}, 1, 1}, {{12.2, 5, 1}, 1, 1}};
    const TraceGraph trace = trace_of(nodes, {{0, 1, 1}, {1, 2, 1}});
    for (const char* frame : {"LPS", "RAS", ""}) {
        const TraceSpace space = placed(frame);
        // The centre of voxel 0, and one step along each axis.
        CHECK(physical_of(space, 0.5 * space.spacing) == space.origin);
        CHECK(physical_of(space, glm::dvec3(1.5, 0.5, 0.5) * space.spacing) == space.origin + glm::dvec3(0, -0.5, 0));
        CHECK(physical_of(space, glm::dvec3(0.5, 1.5, 0.5) * space.spacing) == space.origin + glm::dvec3(0.25, 0, 0));
        for (const char* name : {"a.graphml", "a.txt", "a.swc", "a.rsml"}) {
            CAPTURE(name);
            const auto path = folder.path / name;
            save_trace(path, trace, space, Loops::refuse, Positions::physical);
            const std::string text = content_of(path);
            CHECK(contains(text, "positions are physical, in um, along the axes of"));
            CHECK(contains(text, "-1234.5 0.1 98765.4321"));
            CHECK(contains(text, "0 -1 0 1 0 0 0 0 1"));
            const TraceFile read = load_trace(path, space);
            CHECK(farthest_apart(read.trace, trace) < 1e-10);
            // Files that were written in volume space keep every bit, except RSML.
            save_trace(path, trace, space);
            CHECK(contains(content_of(path), "positions are voxels times spacing"));
            CHECK(farthest_apart(load_trace(path, space).trace, trace) <
                  (path.extension() == ".rsml" ? 1e-14 : 1e-300));
        }
        save_trace(folder.path / "a.graphml", trace, space, Loops::refuse, Positions::physical);
        const TraceFile read = load_trace(folder.path / "a.graphml", space);
        CHECK((read.trace == trace));
        CHECK((read.space == space));
    }
}

TEST_CASE("GraphML in physical space keeps the last bits, unless another program moved a node")
{
    const TemporaryFolder folder;
    const TraceGraph trace = random_trace(7, true);
    const TraceSpace space = placed("LPS");
    const auto path = folder.path / "a.graphml";
    save_trace(path, trace, space, Loops::refuse, Positions::physical);
    CHECK((load_trace(path, space).trace == trace));
    const TraceGraph one = trace_of({{{1.1, 2.2, 3.3}, 1, 1}}, {});
    save_trace(path, one, space, Loops::refuse, Positions::physical);
    std::string text = content_of(path);
    const size_t z = text.find("<data key=\"z\">");
    REQUIRE(z != std::string::npos);
    text.replace(z, text.find("</data>", z) - z, "<data key=\"z\">98769.4321");
    folder.write("b.graphml", text);
    const TraceGraph moved = load_trace(folder.path / "b.graphml", space).trace;
    CHECK(moved.node(0).position.z == doctest::Approx(4.75).epsilon(1e-9));
}

TEST_CASE("a trace that lies elsewhere, or does not say where, is refused")
{
    const TemporaryFolder folder;
    const TraceGraph trace = trace_of({{{1, 2, 3}, 1, 1}}, {});
    const TraceSpace space = placed("LPS");
    for (const char* name : {"a.graphml", "a.txt", "a.swc", "a.rsml"}) {
        CAPTURE(name);
        save_trace(folder.path / name, trace, space, Loops::refuse, Positions::physical);
        const auto with = [&](auto change) {
            TraceSpace other = space;
            change(other);
            return error_of([&] { load_trace(folder.path / name, other); });
        };
        CHECK(
            contains(with([](TraceSpace& s) { s.origin.x += 1.0; }), "of LPS; expected origin -1233.5 0.1 98765.4321"));
        CHECK(contains(with([](TraceSpace& s) { s.directions = glm::dmat3(1.0); }), "expected origin"));
        CHECK(contains(with([](TraceSpace& s) { s.frame = "RAS"; }), "of LPS; expected origin"));
        CHECK(with([](TraceSpace& s) { s.origin.x += 1e-6; }).empty());
        CHECK(with([](TraceSpace& s) { s.frame = ""; }).empty());
        CHECK(with([](TraceSpace& s) { s = SPACE; }).empty());  // states no place
        CHECK(with([](TraceSpace& s) {                          // the same place in the other frame
                  for (int axis = 0; axis < 3; ++axis) s.directions[axis] *= glm::dvec3(-1, -1, 1);
                  s.origin *= glm::dvec3(-1, -1, 1);
                  s.frame = "RAS";
              })
                  .empty());
    }
    CHECK(refusal("a.swc", "# space physical\n1 1 0 0 0 1 -1\n", SPACE) ==
          "a.swc: states that its positions are physical, but not the volume's place; expected origin and directions");
    const std::string place = "# space physical\n# origin 1 2 3\n# directions 1 0 0 0 1 0 0 0 1\n1 1 0 0 0 1 -1\n";
    CHECK(refusal("a.swc", place) ==
          "a.swc: states that its positions are physical, but no spacing; expected one, or the volume's");
    CHECK(refusal("a.swc", place, SPACE).empty());
    CHECK(contains(refusal("a.swc", "# space physical\n# origin 1 2\n"), "a.swc:2: origin is \"1 2\"; expected three"));
    CHECK(contains(refusal("a.swc", "# space physical\n# directions 1 0 0 0 1 0 0 0 -1\n"),
                   "expected three right-handed"));
    CHECK(contains(refusal("a.swc", "# space physical\n# frame XYZ\n"), "frame is \"XYZ\"; expected LPS or RAS"));
    CHECK(contains(refusal("a.swc", "# space physical\n# directions 1 0 0 1 1e-7 0 0 0 1\n"),
                   "expected three right-handed"));
    CHECK(contains(
        refusal("a.swc", "# space physical\n# origin -1e15 0 0\n# directions 1 0 0 0 1 0 0 0 1\n1 1 9e14 0 0 1 -1\n",
                SPACE),
        "a.swc: node 0 lies beyond 1e15 units from the volume's corner; expected it nearer"));
    // Comments of other programs are theirs.
    CHECK(refusal("a.swc", "# space is big\n# origin unknown\n1 1 0 0 0 1 -1\n", SPACE).empty());
}
