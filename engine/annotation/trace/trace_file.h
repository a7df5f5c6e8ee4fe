#pragma once
// Traces in files. The extension determines the format:
//
//   .graphml  everything, including numbers, and the volume's size, spacing and unit; networkx, igraph and yEd read it
//   .txt      the thesis's lines "-v x, y, z, group, radius" and "-l node, node, group"; nodes count from 0
//   .swc      trees (Cannon et al. 1998; one sample a node, its type is the group); size, spacing and unit as comments
//   .rsml     trees (Lobet et al. 2015): plants, roots, polylines, diameters, unit and resolution
//
// Each file states the space of its positions (trace_space.h). Traces are saved in volume space, which preserves
// positions to the last bit. Physical space is for other programs; there only GraphML preserves the last bits, since it
// holds both spaces. A file that states no space is in volume space. In the thesis's text, as in SWC, lines that begin
// with "#" state it. Everything is in the volume's unit, except in RSML, which counts in pixels: written as voxels
// along x. Other units of length are converted on reading. A round trip of RSML costs the last bit or two. In SWC and
// RSML an internode has no group of its own, and only GraphML preserves numbers and the radii of groups.
//
// Files are untrusted: every refusal is one sentence with file, line or element, value and what was expected. Any
// thread may call these.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/trace/trace_space.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr {

/// How to handle loops in a format that holds only trees. `break_open` leaves out one internode of each loop, the one
/// with the largest number (drawn last); a comment in the file and the return value list these internodes.
enum class Loops { refuse, break_open };

/// Writes as `write_file_atomically` does. Returns a sentence for each omission.
std::vector<std::string> save_trace(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space,
                                    Loops loops = Loops::refuse, Positions positions = Positions::volume);

/// The text that `save_trace` would write; fails if `save_trace` would fail.
std::string trace_text(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space);

struct TraceFile {
    TraceGraph trace;
    std::optional<TraceSpace> space;  ///< the file's space; null unless the file states all parts of it
    /// Oddities that were skipped in SWC, GraphML and RSML files of other programs (one sentence per kind), and
    /// assumptions that were made. Such a file may hold more than the trace: keep it before saving over it.
    std::vector<std::string> warnings{};
};
/// Returns the trace in volume space. A file may have at most 256 MiB and 4 million nodes. Lengths are converted to the
/// unit of `expected`. Fails if a stated size, spacing, place or (non-length) unit differs from `expected`.
TraceFile load_trace(const std::filesystem::path& path, const std::optional<TraceSpace>& expected);

/// Whether `load_trace` supports the extension.
bool is_trace_file(const std::filesystem::path& path);

}  // namespace shvr
