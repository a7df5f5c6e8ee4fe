// RSML, the Root System Markup Language (Lobet et al. 2015, Plant Physiology 167; https://rootsystemml.github.io):
// every tree is a plant. Its first axis follows the longest path from the root; each side branch is a root nested in
// its parent axis and begins at the branch. Geometry is in pixels (voxels along x, on all axes), `resolution` pixels
// per unit. Metadata of SHVR's own state the space and, measured in `unit`, the position of the volume.

#include <algorithm>
#include <map>
#include "engine/annotation/trace/trace_forms.h"
#include "engine/annotation/trace/trace_xml.h"

namespace shvr {

namespace {

struct Branch {
    uint32_t node;
    double reach;  ///< length of the longest path to a leaf, including the internode to this node
};

/// The children of each node, sorted by the length of the longest path through each child, longest first.
std::map<uint32_t, std::vector<Branch>> branches_of(const TraceGraph& trace, const TraceTrees& trees)
{
    std::map<uint32_t, std::vector<Branch>> branches;
    for (auto place = trees.places.rbegin(); place != trees.places.rend(); ++place) {  // children come before parents
        std::vector<Branch>& children = branches[place->node];
        std::reverse(children.begin(), children.end());  // in drawing order
        std::stable_sort(children.begin(), children.end(),
                         [](const Branch& a, const Branch& b) { return a.reach > b.reach; });
        if (!place->internode) continue;
        const TraceInternode& internode = trace.internode(*place->internode);
        const double on = children.empty() ? 0.0 : children.front().reach;
        branches[internode.other(place->node)].push_back({place->node, trace.length_of(internode) + on});
    }
    return branches;
}

void add_text(pugi::xml_node parent, const char* name, const std::string& text)
{
    parent.append_child(name).text().set(text.c_str());
}

/// Adds an axis, with its nodes from the branch (or root) at which it begins.
void add_axis(pugi::xml_node root, const TraceGraph& trace, const std::vector<uint32_t>& nodes, double pixel)
{
    pugi::xml_node properties = root.append_child("properties");
    add_text(properties, "group", std::to_string(trace.node(nodes.back()).group));
    pugi::xml_node polyline = root.append_child("geometry").append_child("polyline");
    pugi::xml_node function = root.append_child("functions").append_child("function");
    function.append_attribute("name") = "diameter";
    function.append_attribute("domain") = "polyline";
    pugi::xml_node groups = function.parent().append_child("function");
    groups.append_attribute("name") = "group";
    groups.append_attribute("domain") = "polyline";
    for (const uint32_t number : nodes) {
        const TraceNode& node = trace.node(number);
        const char* const names[] = {"x", "y", "z"};
        pugi::xml_node point = polyline.append_child("point");
        for (int axis = 0; axis < 3; ++axis)
            point.append_attribute(names[axis]) = digits_of(node.position[axis] / pixel).c_str();
        function.append_child("sample").append_attribute("value") = digits_of(2.0 * node.radius / pixel).c_str();
        groups.append_child("sample").append_attribute("value") = int{node.group};
    }
}

}  // namespace

std::string write_trace_rsml(const TraceWriting& writing, Loops loops, std::vector<std::string>& notes)
{
    const TraceGraph& trace = writing.trace;
    const TraceSpace& space = writing.space;
    const TraceTrees trees = trees_of(trace, loops, "RSML", notes);
    const auto branches = branches_of(trace, trees);
    pugi::xml_document document;
    pugi::xml_node rsml = document.append_child("rsml");
    pugi::xml_node metadata = rsml.append_child("metadata");
    add_text(metadata, "version", "1");
    add_text(metadata, "unit", space.unit);
    add_text(metadata, "resolution", digits_of(1.0 / space.spacing.x));
    add_text(metadata, "software", "SHVR");
    add_text(metadata, "positions", in_words(space, writing.positions));
    for (const auto& [name, value] : statements_of(space, writing.positions)) add_text(metadata, name, value);
    add_text(metadata, "spacing", digits_of(space.spacing));
    pugi::xml_node scene = rsml.append_child("scene");
    struct Axis {
        pugi::xml_node parent;
        std::vector<uint32_t> nodes;  ///< the first one or two
    };
    int plants = 0, roots = 0;
    for (const TraceTrees::Place& place : trees.places) {
        if (place.internode) continue;
        pugi::xml_node plant = scene.append_child("plant");
        plant.append_attribute("ID") = ++plants;
        std::vector<Axis> waiting{{plant, {place.node}}};
        while (!waiting.empty()) {
            Axis axis = std::move(waiting.back());
            waiting.pop_back();
            pugi::xml_node root = axis.parent.append_child("root");
            root.append_attribute("ID") = ++roots;
            const size_t given = axis.nodes.size();
            while (!branches.at(axis.nodes.back()).empty())
                axis.nodes.push_back(branches.at(axis.nodes.back()).front().node);
            add_axis(root, trace, axis.nodes, space.spacing.x);
            // Skips the node at which a side axis begins, because that node belongs to the parent axis.
            for (size_t i = given - 1; i < axis.nodes.size(); ++i) {
                const std::vector<Branch>& children = branches.at(axis.nodes[i]);
                for (size_t child = 1; child < children.size(); ++child)
                    waiting.push_back({root, {axis.nodes[i], children[child].node}});
            }
        }
    }
    StringWriter writer;
    document.save(writer, " ");
    return std::move(writer.text);
}

}  // namespace shvr
