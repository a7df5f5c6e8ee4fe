#include "engine/annotation/trace/trace_forms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/grid.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

constexpr size_t MAX_NODES = 4'000'000;
/// Limit far beyond any volume in any unit, yet small enough that squares do not overflow.
constexpr double FARTHEST = 1e15;

std::optional<double> finite_of(std::string_view word)
{
    const std::optional<double> value = number_of(word);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Union-find over nodes (linking roots, path halving).
class Joined {
public:
    uint32_t root_of(uint32_t node)
    {
        auto at = parents_.try_emplace(node, node).first;
        while (at->second != at->first) {
            const auto above = parents_.find(at->second);
            at->second = above->second;
            at = above;
        }
        return at->first;
    }
    /// False if the two were joined already.
    bool join(uint32_t a, uint32_t b)
    {
        const uint32_t low = std::min(root_of(a), root_of(b)), high = std::max(root_of(a), root_of(b));
        parents_[high] = low;
        return low != high;
    }

private:
    std::map<uint32_t, uint32_t> parents_;
};

}  // namespace

uint32_t TraceReader::add_node(const std::string& where, const TraceNode& node, std::optional<uint32_t> number)
{
    if (trace.nodes().size() == MAX_NODES)
        fail(where, ": exceeds the number of nodes a trace may have; expected at most ", MAX_NODES);
    if (!number && trace.next_node() >> 32 != 0) fail(where, ": no number is left for this node");
    const uint32_t given = number.value_or(uint32_t(trace.next_node()));
    if (trace.nodes().contains(given)) fail(where, ": node ", given, " is defined twice; expected each node once");
    trace.apply(TraceNodeChange{given, {}, node}, Direction::forwards);
    return given;
}

void TraceReader::add_internode(const std::string& where, const TraceInternode& internode,
                                std::optional<uint32_t> number)
{
    for (const uint32_t end : {internode.a, internode.b})
        if (!trace.nodes().contains(end))
            fail(where, ": node ", end, " does not exist; expected one of the file's ", trace.nodes().size(), " nodes");
    if (internode.a == internode.b)
        fail(where, ": joins node ", internode.a, " with itself; expected two different nodes");
    if (trace.internode_between(internode.a, internode.b))
        fail(where, ": joins nodes ", internode.a, " and ", internode.b, " a second time; expected each link once");
    if (!number && trace.next_internode() >> 32 != 0) fail(where, ": no number is left for this internode");
    const uint32_t given = number.value_or(uint32_t(trace.next_internode()));
    if (trace.internodes().contains(given))
        fail(where, ": internode ", given, " is defined twice; expected each internode once");
    trace.apply(TraceInternodeChange{given, {}, internode}, Direction::forwards);
}

double TraceReader::coordinate(const std::string& where, const char* field, std::string_view word) const
{
    const std::optional<double> value = finite_of(word);
    if (!value || std::abs(*value) > FARTHEST)
        fail(where, ": ", field, " is ", in_quotes(word), "; expected a number from -1e15 to 1e15");
    return *value;
}

double TraceReader::radius(const std::string& where, std::string_view word) const
{
    const std::optional<double> value = finite_of(word);
    if (!value || *value < 0.0 || *value > FARTHEST)
        fail(where, ": radius is ", in_quotes(word), "; expected a number from 0 to 1e15");
    return *value;
}

uint8_t TraceReader::group(const std::string& where, std::string_view word) const
{
    const std::optional<int64_t> value = whole_of(word);
    if (!value || *value < 0 || *value > 255)
        fail(where, ": group is ", in_quotes(word), "; expected a whole number from 0 to 255");
    return uint8_t(*value);
}

Size3 TraceReader::size(const std::string& where, std::string_view text) const
{
    const std::vector<std::string_view> words = words_of(text);
    Size3 size{0};
    for (int axis = 0; axis < 3 && words.size() == 3; ++axis) size[axis] = whole_of(words[size_t(axis)]).value_or(0);
    if (glm::any(glm::lessThan(size, Size3(1))) || glm::any(glm::greaterThan(size, Size3(MAX_SIDE))))
        fail(where, ": size is ", in_quotes(text), "; expected three whole numbers from 1 to ", MAX_SIDE);
    return size;
}

glm::dvec3 TraceReader::spacing(const std::string& where, std::string_view text) const
{
    const std::vector<std::string_view> words = words_of(text);
    glm::dvec3 spacing{0.0};
    for (int axis = 0; axis < 3 && words.size() == 3; ++axis)
        spacing[axis] = finite_of(words[size_t(axis)]).value_or(0.0);
    if (!glm::all(glm::greaterThan(spacing, glm::dvec3(0.0))))
        fail(where, ": spacing is ", in_quotes(text), "; expected three numbers above 0");
    return spacing;
}

namespace {

std::vector<double> finite_numbers(std::string_view text)
{
    std::vector<double> numbers;
    for (const std::string_view word : words_of(text)) {
        const std::optional<double> number = finite_of(word);
        if (!number || std::abs(*number) > FARTHEST) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

}  // namespace

void TraceReader::state(const std::string& where, std::string_view name, std::string_view value)
{
    if (name == "space") {
        if (value != "physical" && value != "volume")
            fail(where, ": space is ", in_quotes(value), "; expected physical or volume");
        stated.is_physical = value == "physical";
    } else if (name == "frame") {
        if (value != "LPS" && value != "RAS")
            fail(where, ": frame is ", in_quotes(value), "; expected LPS or RAS, or no frame");
        stated.frame = value;
    } else if (name == "origin") {
        const std::vector<double> n = finite_numbers(value);
        if (n.size() != 3) fail(where, ": origin is ", in_quotes(value), "; expected three numbers from -1e15 to 1e15");
        stated.origin = {n[0], n[1], n[2]};
    } else if (name == "directions") {
        const std::vector<double> n = finite_numbers(value);
        if (n.size() == 9) stated.directions = glm::dmat3(n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]);
        if (n.size() != 9 || !are_axes(*stated.directions))
            fail(where, ": directions is ", in_quotes(value), "; expected three right-handed vectors of length 1");
    }
}

void TraceReader::read_past(const Error& odd, const std::string& done)
{
    const std::string text = odd.what();
    const size_t at = text.rfind("; expected ");
    const std::string kind = (at == std::string::npos ? text : text.substr(at)) + done;
    for (Oddity& known : warnings_)
        if (known.kind == kind) {
            ++known.count;
            return;
        }
    warnings_.push_back({text + "; " + done, kind, 1});
}

std::vector<std::string> TraceReader::warnings() const
{
    std::vector<std::string> texts;
    for (const Oddity& each : warnings_)
        texts.push_back(each.count == 1 ? each.first
                                        : sentence(each.first, ", and so on in ", each.count - 1, " more places"));
    return texts;
}

void TraceReader::refuse_if_nothing_is_left() const
{
    if (!trace.nodes().empty()) return;
    for (const Oddity& each : warnings_)
        if (!each.kind.empty()) fail(each.first, "; no node is left");
}

void TraceReader::to_unit_of(const std::optional<TraceSpace>& expected)
{
    if (!expected || !stated.unit || *stated.unit == expected->unit) return;
    const std::optional<double> from = micrometres_in(*stated.unit), to = micrometres_in(expected->unit);
    if (!from || !to) return;
    const double factor = *from / *to;
    std::vector<TraceNodeChange> changes;
    for (const auto& [number, node] : trace.nodes())
        changes.push_back({number, node, TraceNode{node.position * factor, node.radius * factor, node.group}});
    for (const TraceNodeChange& change : changes) trace.apply(change, Direction::forwards);
    std::vector<TraceSizeChange> sizes;
    for (const auto& [group, radius] : trace.internode_radii()) sizes.push_back({group, radius, radius * factor});
    for (const TraceSizeChange& change : sizes) trace.apply(change, Direction::forwards);
    for (auto& [number, position] : exact) position *= factor;
    if (stated.spacing) *stated.spacing *= factor;
    if (stated.origin) *stated.origin *= factor;
    warn(sentence(file_, ": lengths were converted from ", *stated.unit, " to ", expected->unit,
                  ", the unit of the volume"));
    stated.unit = expected->unit;
}

void TraceReader::to_volume_space(const std::optional<TraceSpace>& expected)
{
    if (!stated.is_physical) return;
    if (!stated.origin || !stated.directions)
        fail(file_,
             ": states that its positions are physical, but not the volume's place; expected origin and directions");
    if (!stated.spacing && !expected)
        fail(file_, ": states that its positions are physical, but no spacing; expected one, or the volume's");
    TraceSpace space{.spacing = stated.spacing ? *stated.spacing : expected->spacing,
                     .directions = *stated.directions,
                     .origin = *stated.origin};
    // Tolerance between the file's exact position and the position computed from the physical one: rounding errors of
    // numbers of this size, amplified if the axes are nearly coplanar.
    const double rounding = 1e-14 / glm::determinant(space.directions);
    std::vector<TraceNodeChange> changes;
    for (const auto& [number, node] : trace.nodes()) {
        TraceNode moved = node;
        moved.position = position_of(space, node.position);
        if (const auto found = exact.find(number); found != exact.end()) {
            const glm::dvec3 apart = glm::abs(found->second - moved.position);
            const double most = rounding * (glm::length(node.position) + glm::length(space.origin) +
                                            glm::length(moved.position) + glm::length(space.spacing));
            if (glm::all(glm::lessThanEqual(apart, glm::dvec3(most)))) moved.position = found->second;
        }
        const glm::dvec3 far = glm::abs(moved.position);
        if (!(std::max({far.x, far.y, far.z}) <= FARTHEST))
            fail(file_, ": node ", number, " lies beyond 1e15 ", stated.unit.value_or("units"),
                 " from the volume's corner; expected it nearer");
        changes.push_back({number, node, moved});
    }
    for (const TraceNodeChange& change : changes) trace.apply(change, Direction::forwards);
}

std::string comments_of(const TraceWriting& writing)
{
    const TraceSpace& space = writing.space;
    std::string text = "# SHVR trace\n# " + in_words(space, writing.positions) + "\n";
    for (const auto& [name, value] : statements_of(space, writing.positions))
        text += std::string("# ") + name + " " + value + "\n";
    return text + "# unit " + space.unit + "\n# spacing " + digits_of(space.spacing) + "\n# size " +
           digits_of(space.size) + "\n";
}

void read_space_comment(TraceReader& reader, const std::string& where, std::string_view comment)
{
    const std::vector<std::string_view> words = words_of(comment.substr(1));
    if (words.size() < 2) return;
    const std::string_view rest = trimmed(comment.substr(size_t(words[0].data() - comment.data()) + words[0].size()));
    if (words[0] == "unit") reader.stated.unit = plain_unit(rest);
    if (words[0] == "size" && words.size() == 4) reader.stated.size = reader.size(where, rest);
    if (words[0] == "spacing" && words.size() == 4) reader.stated.spacing = reader.spacing(where, rest);
    const bool is_space = words[0] == "space" && (rest == "physical" || rest == "volume");
    const bool is_place = words[0] == "frame" || words[0] == "origin" || words[0] == "directions";
    if (is_space || (is_place && reader.stated.is_physical)) reader.state(where, words[0], rest);
}

TraceTrees trees_of(const TraceGraph& trace, Loops loops, const char* form, std::vector<std::string>& notes)
{
    TraceTrees trees;
    Joined joined;
    for (const auto& [number, internode] : trace.internodes())
        if (!joined.join(internode.a, internode.b)) trees.left_out.push_back(number);
    for (const uint32_t number : trees.left_out) {
        const TraceInternode& internode = trace.internode(number);
        if (loops == Loops::refuse)
            fail("the trace has ", trees.left_out.size(), " loops, one of them closed by internode ", number,
                 " between nodes ", internode.a, " and ", internode.b, ", and ", form,
                 " holds trees; expected no loop: give --break-loops to leave such internodes out");
        notes.push_back(sentence("internode ", number, " between nodes ", internode.a, " and ", internode.b,
                                 " is left out: it closes a loop, and ", form, " holds trees"));
    }
    std::set<uint32_t> seen;
    std::vector<TraceTrees::Place> waiting;
    for (const auto& [root, node] : trace.nodes()) {
        if (seen.contains(root)) continue;
        waiting.push_back({root, {}});
        while (!waiting.empty()) {
            const TraceTrees::Place place = waiting.back();
            waiting.pop_back();
            trees.places.push_back(place);
            seen.insert(place.node);
            const std::span<const uint32_t> internodes = trace.internodes_of(place.node);
            for (auto number = internodes.rbegin(); number != internodes.rend(); ++number)
                if (*number != place.internode && !std::ranges::binary_search(trees.left_out, *number))
                    waiting.push_back({trace.internode(*number).other(place.node), *number});
        }
    }
    return trees;
}

}  // namespace shvr
