#pragma once
// The formats of trace_file.h, a writer and a reader for each, and shared helpers. These functions convert from and to
// text; they do not access files. Any thread may call them.

#include <map>
#include <string>
#include <string_view>

#include "engine/annotation/trace/trace_file.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

/// The input of a writer: a trace whose positions are already in the space that the file will state.
struct TraceWriting {
    const TraceGraph& trace;
    const TraceSpace& space;
    Positions positions = Positions::volume;
    const TraceGraph* exact = nullptr;  ///< the same trace in volume space; given if `positions` are physical
};

std::string write_trace_text(const TraceWriting& writing);
std::string write_trace_swc(const TraceWriting& writing, Loops loops, std::vector<std::string>& notes);
std::string write_trace_graphml(const TraceWriting& writing);
std::string write_trace_rsml(const TraceWriting& writing, Loops loops, std::vector<std::string>& notes);

/// The volume's properties that a file states; each may be missing.
struct StatedSpace {
    std::optional<Size3> size;
    std::optional<glm::dvec3> spacing;
    std::optional<std::string> unit;
    bool is_physical = false;
    std::optional<glm::dvec3> origin;
    std::optional<glm::dmat3> directions;
    std::string frame;
};

class TraceReader;
/// Lines that begin with "#": first the space of the positions, in words and in the form that `read_space_comment`
/// reads, then the unit, spacing and size.
std::string comments_of(const TraceWriting& writing);
/// Reads a comment, which begins with "#". Since comments of other programs may use the same words, "space" counts only
/// before "physical" or "volume", and a place only after a comment "space physical".
void read_space_comment(TraceReader& reader, const std::string& where, std::string_view comment);

/// Collects the nodes and internodes of a file. Refuses malformed traces, and skips elements of other programs that
/// cannot be used (oddities). Every message begins with `where`.
class TraceReader {
public:
    explicit TraceReader(std::string file) : file_(std::move(file)) {}

    const std::string& file() const { return file_; }
    /// Adds a node. Nodes are numbered in order of appearance, unless `number` is given.
    uint32_t add_node(const std::string& where, const TraceNode& node, std::optional<uint32_t> number = {});
    void add_internode(const std::string& where, const TraceInternode& internode, std::optional<uint32_t> number = {});

    double coordinate(const std::string& where, const char* field, std::string_view word) const;
    double radius(const std::string& where, std::string_view word) const;
    uint8_t group(const std::string& where, std::string_view word) const;
    Size3 size(const std::string& where, std::string_view text) const;
    glm::dvec3 spacing(const std::string& where, std::string_view text) const;

    /// Reads a statement as written by `statements_of`; ignores unknown names. "space" must be "physical" or "volume".
    void state(const std::string& where, std::string_view name, std::string_view value);
    /// Converts positions to volume space if the file states that they are physical. If the file states no spacing,
    /// uses the spacing of `expected`.
    void to_volume_space(const std::optional<TraceSpace>& expected);

    /// Records an oddity that was skipped, and how it was handled ("left out"). Oddities with the same expectation in
    /// their messages are of one kind; only the first of each kind is kept, with the number of oddities of that kind.
    void read_past(const Error& odd, const std::string& done);
    /// Runs `read`, which reads an element. If `read` fails, the element is left out.
    template <class Read>
    void leave_out_if_odd(const Read& read)
    {
        try {
            read();
        } catch (const Error& odd) {
            read_past(odd, "it is left out");
        }
    }
    /// If everything read was an oddity, fails with the first one.
    void refuse_if_nothing_is_left() const;
    /// One sentence for each kind of oddity.
    std::vector<std::string> warnings() const;
    void warn(const std::string& warning) { warnings_.push_back({warning, {}, 1}); }

    /// Converts lengths to the unit of `expected` if the file states another unit and both are units of length.
    void to_unit_of(const std::optional<TraceSpace>& expected);

    StatedSpace stated{};
    TraceGraph trace{};
    std::map<uint32_t, glm::dvec3> exact{};  ///< positions in volume space of nodes whose file also holds physical
                                             ///< positions; used if the two agree

private:
    struct Oddity {
        std::string first, kind;
        int64_t count;
    };
    std::string file_;
    std::vector<Oddity> warnings_;
};

void read_trace_text(TraceReader& reader, std::string_view text);
void read_trace_swc(TraceReader& reader, std::string_view text);
void read_trace_graphml(TraceReader& reader, std::string_view text);
/// Converts lengths to the unit of `volume`, if both units are units of length.
void read_trace_rsml(TraceReader& reader, std::string_view text, const std::optional<TraceSpace>& volume);

/// A trace as trees: contains every node once, parents before children.
struct TraceTrees {
    struct Place {
        uint32_t node;
        std::optional<uint32_t> internode;  ///< to the parent
    };
    std::vector<Place> places;         ///< depth first; roots (by ascending number) have no internode
    std::vector<uint32_t> left_out{};  ///< internodes that close loops, ascending
};
/// Fails if the trace has loops and `loops` does not allow breaking them open. `form`: format for messages ("SWC").
TraceTrees trees_of(const TraceGraph& trace, Loops loops, const char* form, std::vector<std::string>& notes);

}  // namespace shvr
