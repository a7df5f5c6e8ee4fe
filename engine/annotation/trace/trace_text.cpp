// The thesis's text format (appendix D.0.2): "-v x-position, y-position, z-position, colour_group, node_size" for each
// node and "-l node_1_index, node_2_index, colour_group" for each internode. A node's index is its position among the
// file's nodes, from 0; deleted nodes have no index. Lines before the nodes begin with "#" and state the space of the
// positions. Blank lines and other white space are accepted, too.

#include <algorithm>

#include "engine/annotation/trace/trace_forms.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

/// The words after "-v" or "-l".
std::vector<std::string_view> values_of(const std::string& where, std::string_view line, size_t count,
                                        const char* expected)
{
    std::vector<std::string_view> values;
    for (std::string_view rest = line.substr(2);;) {
        const size_t comma = std::min(rest.find(','), rest.size());
        values.push_back(trimmed(rest.substr(0, comma)));
        if (comma == rest.size()) break;
        rest.remove_prefix(comma + 1);
    }
    if (values.size() != count) fail(where, ": is ", in_quotes(line), "; expected ", expected);
    return values;
}

uint32_t index_of(const std::string& where, std::string_view word, size_t nodes)
{
    const std::optional<int64_t> index = whole_of(word);
    if (!index || *index < 0 || *index >= int64_t(nodes))
        fail(where, ": node index is ", in_quotes(word), "; expected a whole number from 0, below ", nodes,
             ", the number of nodes in the file");
    return uint32_t(*index);
}

}  // namespace

std::string write_trace_text(const TraceWriting& writing)
{
    const TraceGraph& trace = writing.trace;
    std::string text = comments_of(writing);
    std::map<uint32_t, size_t> index;
    for (const auto& [number, node] : trace.nodes()) {
        index.emplace(number, index.size());
        text += "-v " + digits_of(node.position.x) + ", " + digits_of(node.position.y) + ", " +
                digits_of(node.position.z) + ", " + std::to_string(node.group) + ", " + digits_of(node.radius) + "\n";
    }
    for (const auto& [number, internode] : trace.internodes())
        text += "-l " + std::to_string(index.at(internode.a)) + ", " + std::to_string(index.at(internode.b)) + ", " +
                std::to_string(internode.group) + "\n";
    return text;
}

void read_trace_text(TraceReader& reader, std::string_view text)
{
    struct Link {
        int line;
        std::string_view text;
    };
    std::vector<Link> links;  // may precede their nodes
    for (int number = 1; !text.empty(); ++number) {
        const std::string_view line = trimmed(take_line(text));
        if (line.starts_with("#")) read_space_comment(reader, sentence(reader.file(), ":", number), line);
        if (line.empty() || line.starts_with("#")) continue;
        if (line.starts_with("-l")) {
            links.push_back({number, line});
            continue;
        }
        const std::string where = sentence(reader.file(), ":", number);
        if (!line.starts_with("-v"))
            fail(where, ": is ", in_quotes(line), "; expected a line that begins with -v or -l");
        const auto values = values_of(where, line, 5, "-v x, y, z, group, radius");
        reader.add_node(where, {{reader.coordinate(where, "x", values[0]), reader.coordinate(where, "y", values[1]),
                                 reader.coordinate(where, "z", values[2])},
                                reader.radius(where, values[4]),
                                reader.group(where, values[3])});
    }
    const size_t nodes = reader.trace.nodes().size();
    for (const Link& link : links) {
        const std::string where = sentence(reader.file(), ":", link.line);
        const auto values = values_of(where, link.text, 3, "-l node, node, group");
        reader.add_internode(where, {index_of(where, values[0], nodes), index_of(where, values[1], nodes),
                                     reader.group(where, values[2])});
    }
}

}  // namespace shvr
