#include "engine/annotation/trace/trace_file.h"

#include <cmath>
#include <span>

#include "engine/annotation/trace/trace_forms.h"
#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

constexpr int64_t MAX_BYTES = int64_t{256} << 20;

std::string extension_of(const std::filesystem::path& path)
{
    return lower_case(path.extension().string());
}

[[noreturn]] void refuse_extension(const std::filesystem::path& path, const char* expected)
{
    fail(path.string(), ": has the extension ", in_quotes(path.extension().string()), "; expected ", expected);
}

/// Whether two vectors are equal, up to the rounding of other programs.
bool is_equal(const glm::dvec3& a, const glm::dvec3& b)
{
    return glm::all(glm::lessThanEqual(glm::abs(a - b), 1e-6 * glm::abs(b)));
}

void check_space(const std::string& file, const StatedSpace& stated, const TraceSpace& expected)
{
    if (stated.size && *stated.size != expected.size)
        fail(file, ": is of a volume of ", digits_of(*stated.size), " voxels; expected ", digits_of(expected.size),
             ", the size of this one");
    if (stated.unit && *stated.unit != expected.unit)
        fail(file, ": is in the unit ", in_quotes(*stated.unit), "; expected ", in_quotes(expected.unit),
             ", the unit of this volume");
    if (stated.spacing && !is_equal(*stated.spacing, expected.spacing))
        fail(file, ": is of a volume with voxels of ", spacing_in_words(*stated.spacing, expected.unit), "; expected ",
             spacing_in_words(expected.spacing, expected.unit), ", the spacing of this one");
    if (!stated.is_physical) return;
    TraceSpace found{.spacing = expected.spacing,
                     .unit = expected.unit,
                     .directions = *stated.directions,
                     .origin = *stated.origin,
                     .frame = stated.frame};
    const std::string elsewhere = why_elsewhere(found, expected);
    if (!elsewhere.empty()) fail(file, ": is of a volume with ", elsewhere, ", where this one lies");
}

/// A copy whose nodes are in physical space.
TraceGraph in_physical_space(const TraceGraph& trace, const TraceSpace& space)
{
    TraceGraph placed = trace;
    for (const auto& [number, node] : trace.nodes()) {
        TraceNode moved = node;
        moved.position = physical_of(space, node.position);
        placed.apply(TraceNodeChange{number, node, moved}, Direction::forwards);
    }
    return placed;
}

std::string text_of(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space, Loops loops,
                    Positions positions, std::vector<std::string>& notes)
{
    const std::string form = extension_of(path);
    if (!is_trace_file(path)) refuse_extension(path, ".graphml, .txt, .swc or .rsml");
    const bool is_physical = positions == Positions::physical;
    const TraceGraph placed = is_physical ? in_physical_space(trace, space) : TraceGraph();
    const TraceWriting writing{is_physical ? placed : trace, space, positions, is_physical ? &trace : nullptr};
    try {
        return form == ".graphml" ? write_trace_graphml(writing)
               : form == ".txt"   ? write_trace_text(writing)
               : form == ".swc"   ? write_trace_swc(writing, loops, notes)
                                  : write_trace_rsml(writing, loops, notes);
    } catch (const Error& error) {
        fail(path.string(), ": ", error.what());
    }
}

}  // namespace

std::string trace_text(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space)
{
    std::vector<std::string> none;
    return text_of(path, trace, space, Loops::refuse, Positions::volume, none);
}

std::vector<std::string> save_trace(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space,
                                    Loops loops, Positions positions)
{
    std::vector<std::string> notes;
    const std::string text = text_of(path, trace, space, loops, positions, notes);
    write_file_atomically(path, std::as_bytes(std::span(text)));
    return notes;
}

TraceFile load_trace(const std::filesystem::path& path, const std::optional<TraceSpace>& expected)
{
    const std::string form = extension_of(path);
    if (!is_trace_file(path)) refuse_extension(path, ".graphml, .txt, .swc or .rsml");
    const std::string bytes = read_text(path, MAX_BYTES);
    constexpr std::string_view BYTE_ORDER_MARK = "\xef\xbb\xbf";
    std::string_view text = bytes;
    if (text.starts_with(BYTE_ORDER_MARK)) text.remove_prefix(BYTE_ORDER_MARK.size());
    TraceReader reader(path.string());
    if (form == ".graphml")
        read_trace_graphml(reader, text);
    else if (form == ".txt")
        read_trace_text(reader, text);
    else if (form == ".rsml")
        read_trace_rsml(reader, text, expected);
    else
        read_trace_swc(reader, text);
    reader.refuse_if_nothing_is_left();
    if (form == ".swc" && expected && !reader.stated.unit && expected->unit != "um" && !reader.trace.nodes().empty())
        reader.warn(
            sentence(path.string(), ": states no unit; its lengths are taken in ", expected->unit,
                     ", the unit of the volume, although SWC files are usually in um: add the line \"# unit um\""
                     " to the file if they are"));
    reader.to_unit_of(expected);
    reader.to_volume_space(expected);
    const StatedSpace& stated = reader.stated;
    if (expected) check_space(path.string(), stated, *expected);
    TraceFile file{std::move(reader.trace), std::nullopt, reader.warnings()};
    if (!stated.size || !stated.spacing || !stated.unit) return file;
    file.space = {.size = *stated.size, .spacing = *stated.spacing, .unit = *stated.unit};
    if (!stated.is_physical) return file;
    file.space->directions = *stated.directions;
    file.space->origin = *stated.origin;
    file.space->frame = stated.frame;
    return file;
}

bool is_trace_file(const std::filesystem::path& path)
{
    const std::string form = extension_of(path);
    return form == ".graphml" || form == ".txt" || form == ".swc" || form == ".rsml";
}

}  // namespace shvr
