// GraphML (Brandes et al. 2002; http://graphml.graphdrawing.org): nodes have x, y, z, radius and group, edges a group,
// and the graph itself has data for the rest of a trace. Ids contain the numbers: node "n7", edge "e3".

#include <charconv>
#include <map>
#include <set>

#include "engine/annotation/trace/trace_forms.h"
#include "engine/annotation/trace/trace_xml.h"
#include "engine/base/error.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

void add_data(pugi::xml_node parent, const char* key, const std::string& value)
{
    pugi::xml_node data = parent.append_child("data");
    data.append_attribute("key") = key;
    data.text().set(value.c_str());
}

/// Returns 7 for "n7"; null unless the id has this form, without leading zeros.
std::optional<uint32_t> number_in(std::string_view id, char letter)
{
    uint32_t number = 0;
    if (id.size() < 2 || id[0] != letter || (id[1] == '0' && id.size() > 2)) return std::nullopt;
    const auto [end, error] = std::from_chars(id.data() + 1, id.data() + id.size(), number);
    return error == std::errc() && end == id.data() + id.size() ? std::optional(number) : std::nullopt;
}

class GraphmlReader {
public:
    explicit GraphmlReader(TraceReader& reader) : reader_(reader) {}

    void read(std::string_view text)
    {
        pugi::xml_document document;
        const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
        const pugi::xml_node root = document.document_element();
        if (!result || name_of(root) != "graphml")
            fail(reader_.file(),
                 ": cannot be read as GraphML: ", result ? "it has no element graphml" : result.description(),
                 "; expected a complete XML document");
        pugi::xml_node graph;
        for (const pugi::xml_node& child : root.children()) {
            if (name_of(child) == "key") add_key(child);
            if (name_of(child) == "graph" && !graph) graph = child;
        }
        if (!graph) fail(reader_.file(), ": has no element graph; expected one");
        read_graph(graph);
    }

private:
    using Data = std::map<std::string, std::string>;

    struct Key {
        std::string name, domain;
        std::optional<std::string> value_by_default;
    };

    void add_key(const pugi::xml_node& key)
    {
        const char* const id = key.attribute("id").value();
        Key read{key.attribute("attr.name").as_string(id), key.attribute("for").as_string("all"), std::nullopt};
        for (const pugi::xml_node& child : key.children())
            if (name_of(child) == "default") read.value_by_default = std::string(trimmed(child.text().get()));
        keys_[id] = std::move(read);
    }

    /// Maps the names of a node's keys to their values. Keys that are declared for `domain` ("node", "edge") start with
    /// their default values.
    Data data_of(const pugi::xml_node& node, std::string_view domain) const
    {
        Data data;
        for (const auto& [id, key] : keys_)
            if (key.value_by_default && (key.domain == "all" || key.domain == domain))
                data[key.name] = *key.value_by_default;
        for (const pugi::xml_node& child : node.children()) {
            if (name_of(child) != "data") continue;
            const auto key = keys_.find(child.attribute("key").value());
            if (key != keys_.end()) data[key->second.name] = std::string(trimmed(child.text().get()));
        }
        return data;
    }

    void read_graph(const pugi::xml_node& graph)
    {
        std::vector<pugi::xml_node> nodes, edges;
        bool nodes_are_numbered = true, edges_are_numbered = true;
        for (const pugi::xml_node& child : graph.children()) {
            if (name_of(child) == "node") {
                nodes.push_back(child);
                nodes_are_numbered &= number_in(child.attribute("id").value(), 'n').has_value();
            } else if (name_of(child) == "edge") {
                edges.push_back(child);
                edges_are_numbered &= number_in(child.attribute("id").value(), 'e').has_value();
            } else if (name_of(child) == "hyperedge") {
                reader_.read_past(Error(reader_.file() + ": holds a hyperedge; expected edges that join two nodes"),
                                  "it is left out");
            }
        }
        for (const pugi::xml_node& node : nodes) reader_.leave_out_if_odd([&] { read_node(node, nodes_are_numbered); });
        for (const pugi::xml_node& edge : edges) reader_.leave_out_if_odd([&] { read_edge(edge, edges_are_numbered); });
        read_data(data_of(graph, "graph"));
    }

    void read_node(const pugi::xml_node& node, bool is_numbered)
    {
        const std::string id = node.attribute("id").value();
        const std::string where = reader_.file() + ": node " + in_quotes(id);
        if (numbers_.contains(id)) fail(where, ": is defined twice; expected each id once");
        const Data data = data_of(node, "node");
        const auto value = [&](const char* key, const char* otherwise) {
            const auto found = data.find(key);
            if (found != data.end()) return found->second;
            if (!otherwise) fail(where, ": has no data ", in_quotes(key), "; expected x, y and z");
            return std::string(otherwise);
        };
        const TraceNode read{
            {reader_.coordinate(where, "x", value("x", nullptr)), reader_.coordinate(where, "y", value("y", nullptr)),
             reader_.coordinate(where, "z", value("z", nullptr))},
            reader_.radius(where, value("radius", "1")),
            group_of(where, value("group", "1"))};
        const uint32_t number = reader_.add_node(where, read, is_numbered ? number_in(id, 'n') : std::nullopt);
        numbers_.emplace(id, number);
        if (const auto exact = data.find("volume_position"); exact != data.end()) {
            const std::vector<std::string_view> words = words_of(exact->second);
            if (words.size() != 3) fail(where, ": volume_position is ", in_quotes(exact->second), "; expected x y z");
            reader_.exact[number] = {reader_.coordinate(where, "volume_position", words[0]),
                                     reader_.coordinate(where, "volume_position", words[1]),
                                     reader_.coordinate(where, "volume_position", words[2])};
        }
    }

    /// Attributes of the type "double" write "5.0".
    uint8_t group_of(const std::string& where, const std::string& word)
    {
        try {
            return reader_.group(where, word);
        } catch (const Error& odd) {
            const std::optional<double> number = number_of(word);
            if (number && (*number == 0.0 || (*number >= 1.0 && *number <= 255.0 && uint8_t(*number) == *number)))
                return uint8_t(*number);
            reader_.read_past(odd, "group 1 is taken");
            return 1;
        }
    }

    void read_edge(const pugi::xml_node& edge, bool is_numbered)
    {
        const std::string id = edge.attribute("id").value();
        const std::string source = edge.attribute("source").value(), target = edge.attribute("target").value();
        const std::string where =
            reader_.file() + ": edge " + in_quotes(id) + " from " + in_quotes(source) + " to " + in_quotes(target);
        for (const std::string& end : {source, target})
            if (!numbers_.contains(end))
                fail(where, ": node ", in_quotes(end), " does not exist; expected the id of a node of the file");
        const Data data = data_of(edge, "edge");
        const auto group = data.find("group");
        reader_.add_internode(
            where,
            {numbers_.at(source), numbers_.at(target), group_of(where, group == data.end() ? "1" : group->second)},
            is_numbered ? number_in(id, 'e') : std::nullopt);
    }

    void read_data(const Data& data)
    {
        const std::string where = reader_.file() + ": graph";
        uint64_t next[2] = {0, 0};
        const auto space = data.find("space");
        const bool is_ours = space != data.end() && (space->second == "physical" || space->second == "volume");
        for (const auto& [key, value] : data) {
            if (is_ours) reader_.state(where, key, value);
            if (key == "unit") reader_.stated.unit = plain_unit(value);
            if (key == "size") reader_.stated.size = reader_.size(where, value);
            if (key == "spacing") reader_.stated.spacing = reader_.spacing(where, value);
            if (key == "internode_radii") read_radii(where, value);
            if (key != "next_node" && key != "next_internode") continue;
            const std::optional<int64_t> number = whole_of(value);
            if (!number || *number < 0 || *number > int64_t{1} << 32)
                fail(where, ": ", key, " is ", in_quotes(value), "; expected a whole number from 0 to 4294967296");
            next[key == "next_node" ? 0 : 1] = uint64_t(*number);
        }
        reader_.trace.reserve_numbers(next[0], next[1]);
    }

    void read_radii(const std::string& where, std::string_view text)
    {
        for (const std::string_view word : words_of(text)) {
            const size_t equals = word.find('=');
            if (equals == std::string_view::npos)
                fail(where, ": internode_radii holds ", in_quotes(word), "; expected group=radius");
            const uint8_t group = reader_.group(where, word.substr(0, equals));
            if (reader_.trace.internode_radii().contains(group))
                fail(where, ": internode_radii holds group ", int(group), " twice; expected each group once");
            reader_.trace.apply(TraceSizeChange{group, {}, reader_.radius(where, word.substr(equals + 1))},
                                Direction::forwards);
        }
    }

    TraceReader& reader_;
    std::map<std::string, Key> keys_;          ///< by id
    std::map<std::string, uint32_t> numbers_;  ///< id of a node -> its number
};

/// Declares the attributes of nodes, edges and the graph.
void add_keys(pugi::xml_node& root)
{
    constexpr const char* KEYS[][3] = {{"x", "node", "double"},
                                       {"y", "node", "double"},
                                       {"z", "node", "double"},
                                       {"radius", "node", "double"},
                                       {"group", "all", "int"},
                                       {"volume_position", "node", "string"},
                                       {"positions", "graph", "string"},
                                       {"space", "graph", "string"},
                                       {"frame", "graph", "string"},
                                       {"origin", "graph", "string"},
                                       {"directions", "graph", "string"},
                                       {"unit", "graph", "string"},
                                       {"size", "graph", "string"},
                                       {"spacing", "graph", "string"},
                                       {"internode_radii", "graph", "string"},
                                       {"next_node", "graph", "long"},
                                       {"next_internode", "graph", "long"}};
    for (const auto& [name, domain, type] : KEYS) {
        pugi::xml_node key = root.append_child("key");
        key.append_attribute("id") = name;
        key.append_attribute("for") = domain;
        key.append_attribute("attr.name") = name;
        key.append_attribute("attr.type") = type;
    }
}

/// Adds the data of the graph as a whole: the space of its positions, and properties of the volume.
void add_statements(pugi::xml_node& graph, const TraceWriting& writing)
{
    const TraceGraph& trace = writing.trace;
    const TraceSpace& space = writing.space;
    add_data(graph, "positions", in_words(space, writing.positions));
    for (const auto& [name, value] : statements_of(space, writing.positions)) add_data(graph, name, value);
    add_data(graph, "unit", space.unit);
    add_data(graph, "size", digits_of(space.size));
    add_data(graph, "spacing", digits_of(space.spacing));
    std::string radii;
    for (const auto& [group, radius] : trace.internode_radii())
        radii += (radii.empty() ? "" : " ") + std::to_string(group) + "=" + digits_of(radius);
    add_data(graph, "internode_radii", radii);
    add_data(graph, "next_node", std::to_string(trace.next_node()));
    add_data(graph, "next_internode", std::to_string(trace.next_internode()));
}

/// Writes elements of the graph one by one, because the whole document would take 1.6 KB of memory per node.
class ElementWriter {
public:
    explicit ElementWriter(std::string& text) { writer_.text.swap(text); }
    pugi::xml_node begin(const char* name) { return document_.append_child(name); }
    void end()
    {
        document_.first_child().print(writer_, INDENT, pugi::format_default, pugi::encoding_auto, DEPTH);
        document_.remove_children();
    }
    std::string take() { return std::move(writer_.text); }

    static constexpr const char* INDENT = " ";

private:
    static constexpr unsigned DEPTH = 2;  ///< depth of elements, which lie in "graphml" and "graph"
    pugi::xml_document document_;
    StringWriter writer_;
};

void write_nodes(ElementWriter& writer, const TraceWriting& writing)
{
    for (const auto& [number, node] : writing.trace.nodes()) {
        pugi::xml_node element = writer.begin("node");
        element.append_attribute("id") = ("n" + std::to_string(number)).c_str();
        add_data(element, "x", digits_of(node.position.x));
        add_data(element, "y", digits_of(node.position.y));
        add_data(element, "z", digits_of(node.position.z));
        add_data(element, "radius", digits_of(node.radius));
        add_data(element, "group", std::to_string(node.group));
        // Positions computed from the values above would lack the last bits, so exact positions are written, too.
        if (writing.exact) {
            const glm::dvec3& exact = writing.exact->node(number).position;
            if (position_of(writing.space, node.position) != exact)
                add_data(element, "volume_position", digits_of(exact));
        }
        writer.end();
    }
}

void write_edges(ElementWriter& writer, const TraceGraph& trace)
{
    for (const auto& [number, internode] : trace.internodes()) {
        pugi::xml_node element = writer.begin("edge");
        element.append_attribute("id") = ("e" + std::to_string(number)).c_str();
        element.append_attribute("source") = ("n" + std::to_string(internode.a)).c_str();
        element.append_attribute("target") = ("n" + std::to_string(internode.b)).c_str();
        add_data(element, "group", std::to_string(internode.group));
        writer.end();
    }
}

}  // namespace

std::string write_trace_graphml(const TraceWriting& writing)
{
    pugi::xml_document document;
    pugi::xml_node declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    pugi::xml_node root = document.append_child("graphml");
    root.append_attribute("xmlns") = "http://graphml.graphdrawing.org/xmlns";
    add_keys(root);
    pugi::xml_node graph = root.append_child("graph");
    graph.append_attribute("id") = "trace";
    graph.append_attribute("edgedefault") = "undirected";
    add_statements(graph, writing);
    StringWriter frame;
    document.save(frame, ElementWriter::INDENT);
    const size_t end = frame.text.rfind(" </graph>");
    const std::string closing = frame.text.substr(end);
    frame.text.resize(end);
    ElementWriter writer(frame.text);
    write_nodes(writer, writing);
    write_edges(writer, writing.trace);
    return writer.take() + closing;
}

void read_trace_graphml(TraceReader& reader, std::string_view text)
{
    GraphmlReader(reader).read(text);
}

}  // namespace shvr
