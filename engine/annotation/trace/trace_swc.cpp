// SWC (Cannon et al. 1998, "An on-line archive of reconstructed hippocampal neurons"): one sample per line, "n type x y
// z radius parent", parents before children, parent -1 for a root. Written as SWC+ and the standardised form require:
// numbers from 1 without gaps. The type holds the colour group, since no neurite type fits plants.

#include <map>

#include "engine/annotation/trace/trace_forms.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr int64_t MAX_SAMPLE_NUMBER = (int64_t{1} << 31) - 1;

struct Sample {
    int line;
    uint32_t node;
    std::optional<int64_t> parent;
};

/// "# unit um", as we write it, and "# SCALE 1 1 1", as archives do.
void read_comment(TraceReader& reader, const std::string& where, std::string_view comment)
{
    read_space_comment(reader, where, comment);
    const std::vector<std::string_view> words = words_of(comment.substr(1));
    if (words.size() < 2) return;
    const std::string_view rest = trimmed(comment.substr(size_t(words[0].data() - comment.data()) + words[0].size()));
    if (lower_case(words[0]) == "scale" && words.size() == 4)
        for (size_t axis = 1; axis < 4; ++axis)
            if (number_of(words[axis]) != 1.0)
                fail(where, ": SCALE is ", in_quotes(rest), "; expected 1 1 1: positions in the volume's unit");
}

}  // namespace

std::string write_trace_swc(const TraceWriting& writing, Loops loops, std::vector<std::string>& notes)
{
    const TraceGraph& trace = writing.trace;
    std::vector<std::string> left_out;
    const TraceTrees trees = trees_of(trace, loops, "SWC", left_out);
    std::string text = comments_of(writing) + "# n type x y z radius parent; the type is the colour group\n";
    for (const std::string& note : left_out) text += "# " + note + "\n";
    notes.insert(notes.end(), left_out.begin(), left_out.end());
    std::map<uint32_t, size_t> samples;
    for (const TraceTrees::Place& place : trees.places) {
        const TraceNode& node = trace.node(place.node);
        samples.emplace(place.node, samples.size() + 1);
        text += std::to_string(samples.size()) + " " + std::to_string(node.group) + " " + digits_of(node.position) +
                " " + digits_of(node.radius) + " ";
        text +=
            place.internode ? std::to_string(samples.at(trace.internode(*place.internode).other(place.node))) : "-1";
        text += "\n";
    }
    return text;
}

void read_trace_swc(TraceReader& reader, std::string_view text)
{
    std::vector<Sample> samples;
    std::map<int64_t, uint32_t> nodes;
    for (int number = 1; !text.empty(); ++number) {
        const std::string_view line = trimmed(take_line(text));
        const std::string where = sentence(reader.file(), ":", number);
        if (line.starts_with("#")) read_comment(reader, where, line);
        if (line.empty() || line.starts_with("#")) continue;
        const std::vector<std::string_view> words = words_of(line);
        if (words.size() < 7) fail(where, ": is ", in_quotes(line), "; expected n type x y z radius parent");
        const std::optional<int64_t> sample = whole_of(words[0]), parent = whole_of(words[6]);
        if (!sample || *sample < 0 || *sample > MAX_SAMPLE_NUMBER)
            fail(where, ": n is ", in_quotes(words[0]), "; expected a whole number from 0 to ", MAX_SAMPLE_NUMBER);
        if (!parent || *parent < -1 || *parent > MAX_SAMPLE_NUMBER)
            fail(where, ": parent is ", in_quotes(words[6]), "; expected -1 or the number of a sample");
        const uint32_t node =
            reader.add_node(where, {{reader.coordinate(where, "x", words[2]), reader.coordinate(where, "y", words[3]),
                                     reader.coordinate(where, "z", words[4])},
                                    reader.radius(where, words[5]),
                                    reader.group(where, words[1])});
        if (!nodes.emplace(*sample, node).second)
            fail(where, ": sample ", *sample, " is defined twice; expected each number once");
        samples.push_back({number, node, *parent == -1 ? std::nullopt : parent});
    }
    for (const Sample& sample : samples) {
        if (!sample.parent) continue;
        const std::string where = sentence(reader.file(), ":", sample.line);
        const auto parent = nodes.find(*sample.parent);
        if (parent == nodes.end()) fail(where, ": parent is ", *sample.parent, "; expected -1 or a sample of the file");
        reader.add_internode(where, {parent->second, sample.node, reader.trace.node(sample.node).group});
    }
    // Every sample has at most one parent, so a loop is a sample that is its own ancestor.
    std::vector<std::string> notes;
    try {
        trees_of(reader.trace, Loops::refuse, "SWC", notes);
    } catch (const Error& error) {
        fail(reader.file(), ": ", error.what());
    }
}

}  // namespace shvr
