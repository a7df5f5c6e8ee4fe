#pragma once
// Traces in files. The extension determines the format:
//
//   .graphml  everything, including numbers, and the volume's size, spacing and unit; networkx, igraph and yEd read it
//   .txt      the thesis's lines "-v x, y, z, group, radius" and "-l node, node, group"; nodes count from 0
//   .swc      trees (Cannon et al. 1998; one sample a node, its type is the group); size, spacing and unit as comments
//   .rsml     trees (Lobet et al. 2015): plants, roots, polylines, diameters, unit and resolution
//
// Each file states the space of its positions (trace_space.h), in .txt and .swc by lines that begin with "#"; without a
// statement, it is volume space. Traces are saved in volume space, which preserves positions to the last bit. Physical
// space is for other programs; of its formats only GraphML preserves the last bits, since it holds both spaces. Lengths
// are in the volume's unit, except in RSML, which uses pixels (voxels along x) and may lose the last bit or two. Other
// units of length are converted on reading. In SWC and RSML, internodes have no group of their own. Only GraphML
// preserves numbers and the radii of groups.
//
// Files are untrusted: every error is one sentence with file, line or element, value and expected value. Any thread may
// call these.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/trace/trace_space.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr {

/// How to handle loops in a format that holds only trees. `break_open` leaves out one internode of each loop, the one
/// with the largest number (drawn last); a comment in the file and the return value list the omitted internodes.
enum class Loops { refuse, break_open };

/// Writes atomically, like `write_file_atomically`. Returns a sentence for each omission.
std::vector<std::string> save_trace(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space,
                                    Loops loops = Loops::refuse, Positions positions = Positions::volume);

/// The text that `save_trace` would write; fails if `save_trace` would fail.
std::string trace_text(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space);

struct TraceFile {
    TraceGraph trace;
    std::optional<TraceSpace> space;  ///< the file's space; null unless the file states it completely
    /// One sentence for each kind of oddity that was skipped in SWC, GraphML and RSML files of other programs, and for
    /// each assumption. A file with warnings may hold more than the trace: keep it before saving over it.
    std::vector<std::string> warnings{};
};
/// Returns the trace in volume space. A file may have at most 256 MiB and 4 million nodes. Lengths are converted to the
/// unit of `expected`. Fails if a stated size, spacing, place or (non-length) unit differs from `expected`.
TraceFile load_trace(const std::filesystem::path& path, const std::optional<TraceSpace>& expected);

/// Whether `load_trace` supports the extension.
bool is_trace_file(const std::filesystem::path& path);

}  // namespace shvr
