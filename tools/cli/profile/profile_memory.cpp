// The memory of a frame, by resource: when each resource is needed, and how much memory sharing would save.

#include <algorithm>
#include <numeric>

#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

namespace {

/// A resource of the frame, and the range of steps that need its bytes.
struct Need {
    size_t resource = 0;
    uint64_t bytes = 0;
    size_t first_step = 0, last_step = 0;

    bool overlaps(const Need& other) const { return first_step <= other.last_step && other.first_step <= last_step; }
};

/// Returns the needs in order of the resources' declaration, without resources that no remaining pass uses.
std::vector<Need> needs_of(const FrameGraph& graph, const CompiledGraph& compiled)
{
    std::vector<std::optional<Need>> found(graph.resources().size());
    for (size_t step = 0; step < compiled.steps.size(); ++step)
        for (const Binding& binding : graph.passes()[compiled.steps[step].pass].bindings) {
            const FrameGraph::ResourceData& data = graph.resources()[binding.resource];
            std::optional<Need>& need = found[binding.resource];
            // The host fills an upload before the first step, so an upload's bytes are needed from step 0 on.
            if (!need) need = Need{binding.resource, data.desc.bytes, data.contents.empty() ? step : 0, step};
            need->last_step = step;
        }
    std::vector<Need> needs;
    for (const std::optional<Need>& need : found)
        if (need) needs.push_back(*need);
    return needs;
}

/// Returns the maximum over all steps of the bytes needed: a lower bound for the memory with any kind of sharing.
uint64_t most_at_once(const std::vector<Need>& needs)
{
    uint64_t most = 0;
    for (const Need& at : needs) {  // the sum can only grow at a step where a resource is first needed
        uint64_t sum = 0;
        for (const Need& need : needs)
            if (need.first_step <= at.first_step && at.first_step <= need.last_step) sum += need.bytes;
        most = std::max(most, sum);
    }
    return most;
}

/// Returns the size of a block that holds all resources, placed largest first, each at the lowest offset that is free.
uint64_t packed_bytes(std::vector<Need> needs)
{
    std::stable_sort(needs.begin(), needs.end(), [](const Need& a, const Need& b) { return a.bytes > b.bytes; });
    std::vector<std::pair<uint64_t, Need>> placed;  // by offset
    uint64_t end = 0;
    for (const Need& need : needs) {
        uint64_t offset = 0;
        for (const auto& [other_offset, other] : placed) {
            if (!need.overlaps(other)) continue;
            if (offset + need.bytes <= other_offset) break;
            offset = std::max(offset, other_offset + other.bytes);
        }
        const auto after =
            std::find_if(placed.begin(), placed.end(), [&](const auto& one) { return one.first > offset; });
        placed.insert(after, {offset, need});
        end = std::max(end, offset + need.bytes);
    }
    return end;
}

}  // namespace

Json frame_memory_of(const FrameGraph& graph)
{
    const CompiledGraph compiled = graph.compile();
    const auto pass_at = [&](size_t step) { return graph.passes()[compiled.steps[step].pass].name; };
    const std::vector<Need> needs = needs_of(graph, compiled);
    std::vector<size_t> place_of(graph.resources().size());  // index in the list
    for (size_t i = 0; i < needs.size(); ++i) place_of[needs[i].resource] = i;
    Json resources = Json::array();
    std::vector<Need> transients;
    uint64_t taken = 0;
    for (const Need& need : needs) {
        const FrameGraph::ResourceData& data = graph.resources()[need.resource];
        const bool is_image = data.desc.kind == ResourceDesc::Kind::image;
        const uint32_t memory_of = compiled.memory_of[need.resource];
        if (!data.imported && memory_of == need.resource) taken += need.bytes;
        resources.push_back({{"name", data.name},
                             {"kind", is_image ? "image" : "buffer"},
                             {"format", is_image ? Json(name_of(data.desc.format)) : Json(nullptr)},
                             {"bytes", need.bytes},
                             {"lasting", data.imported},
                             {"memory_of", place_of[memory_of]},
                             {"first_step", need.first_step},
                             {"last_step", need.last_step},
                             {"first_pass", pass_at(need.first_step)},
                             {"last_pass", pass_at(need.last_step)}});
        if (!data.imported) transients.push_back(need);
    }
    const uint64_t sum = std::accumulate(transients.begin(), transients.end(), uint64_t(0),
                                         [](uint64_t bytes, const Need& need) { return bytes + need.bytes; });
    Json names = Json::array();
    for (size_t step = 0; step < compiled.steps.size(); ++step) names.push_back(pass_at(step));
    return {{"steps", compiled.steps.size()},
            {"step_names", names},
            {"resources", resources},
            {"transient_bytes", sum},
            {"transient_taken", taken},
            {"transient_most_at_once", most_at_once(transients)},
            {"transient_packed", packed_bytes(transients)},
            {"sharing_saves", sum > 0 ? double(sum - taken) / double(sum) : 0.0}};
}

}  // namespace shvr::cli
