// SWC (Cannon et al. 1998, "An on-line archive of reconstructed hippocampal neurons"): one sample per line, "n type x y
// z radius parent", parents before children, parent -1 for a root. Samples are numbered from 1 without gaps, as SWC+
// and the standardised form require. The type holds the colour group, since no neurite type fits plants.

#include <cmath>
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

/// Reads "# unit um", as written by SHVR, and "# SCALE 1 1 1", as found in archives of neurons.
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

/// Reads the number of a sample, which some programs write as "1.0".
std::optional<int64_t> number_of_sample(TraceReader& reader, const std::string& where, const char* field,
                                        std::string_view word)
{
    if (const std::optional<int64_t> whole = whole_of(word)) return whole;
    const std::optional<double> number = number_of(word);
    if (!number || *number != std::floor(*number) || std::abs(*number) > double(MAX_SAMPLE_NUMBER)) return std::nullopt;
    reader.read_past(
        Error(sentence(where, ": ", field, " is ", in_quotes(word), "; expected a number without a fraction")),
        "it is taken as one");
    return int64_t(*number);
}

/// Returns a sample's type as a group. A neurite's type may be any number; types that are not a group are dropped.
uint8_t group_of(TraceReader& reader, const std::string& where, std::string_view word)
{
    try {
        return reader.group(where, word);
    } catch (const Error& odd) {
        const std::optional<double> number = number_of(word);
        if (!number) throw;
        const bool is_whole = *number == std::floor(*number) && *number >= 0.0 && *number <= 255.0;
        reader.read_past(odd, is_whole ? "it is taken as one" : "group 1 is taken");
        return is_whole ? uint8_t(*number) : uint8_t{1};
    }
}

Sample sample_of(TraceReader& reader, const std::string& where, int line, std::string_view text,
                 std::map<int64_t, uint32_t>& nodes)
{
    const std::vector<std::string_view> words = words_of(text);
    if (words.size() < 7) fail(where, ": is ", in_quotes(text), "; expected n type x y z radius parent");
    const std::optional<int64_t> sample = number_of_sample(reader, where, "n", words[0]);
    const std::optional<int64_t> parent = number_of_sample(reader, where, "parent", words[6]);
    if (!sample || *sample < 0 || *sample > MAX_SAMPLE_NUMBER)
        fail(where, ": n is ", in_quotes(words[0]), "; expected a whole number from 0 to ", MAX_SAMPLE_NUMBER);
    if (!parent || *parent < -1 || *parent > MAX_SAMPLE_NUMBER)
        fail(where, ": parent is ", in_quotes(words[6]), "; expected -1 or the number of a sample");
    if (nodes.contains(*sample)) fail(where, ": sample ", *sample, " is defined twice; expected each number once");
    const TraceNode node{{reader.coordinate(where, "x", words[2]), reader.coordinate(where, "y", words[3]),
                          reader.coordinate(where, "z", words[4])},
                         reader.radius(where, words[5]),
                         group_of(reader, where, words[1])};
    return {line, nodes.emplace(*sample, reader.add_node(where, node)).first->second,
            *parent == -1 ? std::nullopt : parent};
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
        reader.leave_out_if_odd([&] { samples.push_back(sample_of(reader, where, number, line, nodes)); });
    }
    for (const Sample& sample : samples) {
        if (!sample.parent) continue;
        const std::string where = sentence(reader.file(), ":", sample.line);
        const auto parent = nodes.find(*sample.parent);
        if (parent == nodes.end())
            reader.read_past(
                Error(sentence(where, ": parent is ", *sample.parent, "; expected -1 or a sample of the file")),
                "the sample is taken as a root");
        else
            reader.leave_out_if_odd([&] {
                reader.add_internode(where, {parent->second, sample.node, reader.trace.node(sample.node).group});
            });
    }
    // Refuses loops: as every sample has at most one parent, a sample in a loop is its own ancestor.
    std::vector<std::string> notes;
    try {
        trees_of(reader.trace, Loops::refuse, "SWC", notes);
    } catch (const Error& error) {
        fail(reader.file(), ": ", error.what());
    }
}

}  // namespace shvr
