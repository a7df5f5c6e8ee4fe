#include "engine/graph/graph_text.h"

#include <array>
#include <filesystem>
#include <iomanip>

#include <nlohmann/json.hpp>

namespace shvr {

namespace {

using Json = nlohmann::ordered_json;

/// The step of each pass (indexed by pass), and the first and last step that use each resource.
struct Schedule {
    struct Lifetime {
        size_t first_step = 0, last_step = 0;
    };
    std::vector<std::optional<size_t>> step_of_pass;
    std::vector<std::optional<Lifetime>> lifetimes;

    Schedule(const FrameGraph& graph, const CompiledGraph& compiled)
        : step_of_pass(graph.passes().size()), lifetimes(graph.resources().size())
    {
        for (size_t step = 0; step < compiled.steps.size(); ++step) {
            const uint32_t pass = compiled.steps[step].pass;
            step_of_pass[pass] = step;
            for (const Binding& binding : graph.passes()[pass].bindings) {
                std::optional<Lifetime>& lifetime = lifetimes[binding.resource];
                if (!lifetime) lifetime = Lifetime{step, step};
                lifetime->last_step = step;
            }
        }
    }
};

const char* name_of(PassData::Kind kind)
{
    switch (kind) {
        case PassData::Kind::compute: return "compute";
        case PassData::Kind::fill: return "fill";
        case PassData::Kind::copy_to_image: return "copy to image";
        case PassData::Kind::copy_buffer: return "copy";
        case PassData::Kind::read_back: return "read back";
    }
    return "?";
}

std::string place_of(const PassData& pass)
{
    return sentence(std::filesystem::path(pass.declared_at.file_name()).filename().string(), ":",
                    pass.declared_at.line());
}

std::string extent_text(const glm::uvec3& extent)
{
    return sentence(extent.x, " x ", extent.y, " x ", extent.z);
}

/// "1.5 MiB"
std::string bytes_text(uint64_t bytes)
{
    const std::array<const char*, 4> units{"B", "KiB", "MiB", "GiB"};
    double amount = double(bytes);
    size_t unit = 0;
    for (; amount >= 1024.0 && unit + 1 < units.size(); ++unit) amount /= 1024.0;
    return sentence(std::fixed, std::setprecision(unit == 0 ? 0 : 1), amount, " ", units[unit]);
}

std::string desc_text(const ResourceDesc& desc)
{
    if (desc.kind == ResourceDesc::Kind::buffer) return "buffer, " + bytes_text(desc.bytes);
    return sentence(shvr::name_of(desc.format), " ", extent_text(desc.texels), ", ", bytes_text(desc.bytes));
}

/// Returns several lines as one quoted DOT string, with any special characters escaped.
std::string quoted(const std::vector<std::string>& lines)
{
    std::string text = "\"";
    for (size_t i = 0; i < lines.size(); ++i) {
        if (i > 0) text += "\\n";
        for (const char c : lines[i]) {
            if (c == '"' || c == '\\') text += '\\';
            text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return text + "\"";
}

constexpr const char* CULLED = "style=dashed, color=gray60, fontcolor=gray60";

std::string pass_node(size_t index, const PassData& pass, std::optional<size_t> step,
                      const std::optional<Barrier>& barrier)
{
    std::vector<std::string> lines;
    lines.push_back(step ? sentence(*step, ": ", pass.name) : pass.name + " (culled)");
    if (pass.kind != PassData::Kind::compute)
        lines.emplace_back(name_of(pass.kind));
    else if (pass.kernel != pass.name)
        lines.push_back("kernel " + pass.kernel);
    if (pass.kind == PassData::Kind::compute) lines.push_back(extent_text(pass.threads) + " threads");
    if (pass.tile != glm::uvec3(0)) lines.push_back("in tiles of " + extent_text(pass.tile));
    if (barrier) lines.push_back("barrier " + to_text(*barrier));
    return sentence("    pass", index, " [shape=box, label=", quoted(lines), ", ",
                    step ? "style=filled, fillcolor=\"#e4eefb\"" : CULLED, "];\n");
}

std::string resource_node(size_t index, const FrameGraph::ResourceData& resource,
                          const std::optional<Schedule::Lifetime>& lifetime)
{
    std::vector<std::string> lines{resource.name, desc_text(resource.desc)};
    if (lifetime) lines.push_back(sentence("steps ", lifetime->first_step, " to ", lifetime->last_step));
    return sentence("    resource", index, " [shape=ellipse, peripheries=", resource.imported ? 2 : 1,
                    ", label=", quoted(lines), ", ", lifetime ? "style=filled, fillcolor=\"#fdf3dc\"" : CULLED, "];\n");
}

Json numbers(const glm::uvec3& value)
{
    return {value.x, value.y, value.z};
}

Json barrier_json(const std::optional<Barrier>& barrier)
{
    if (!barrier) return nullptr;
    return {{"from", names_of(barrier->from)}, {"to", names_of(barrier->to)}, {"memory", barrier->memory}};
}

Json pass_json(const FrameGraph& graph, const PassData& pass, std::optional<size_t> step,
               const std::optional<Barrier>& barrier)
{
    Json bindings = Json::array();
    for (const Binding& binding : pass.bindings)
        bindings.push_back({{"name", binding.name},
                            {"resource", graph.resources()[binding.resource].name},
                            {"index", binding.resource},
                            {"reads", binding.reads},
                            {"writes", binding.writes}});
    Json constants = Json::object();
    for (const auto& [name, value] : pass.constants) constants[name] = value;
    return {{"name", pass.name},
            {"kind", name_of(pass.kind)},
            {"kernel", pass.kernel},
            {"alive", step.has_value()},
            {"step", step ? Json(*step) : Json(nullptr)},
            {"barrier", barrier_json(barrier)},
            {"bindings", bindings},
            {"constants", constants},
            {"threads", numbers(pass.threads)},
            {"tile", numbers(pass.tile)},
            {"declared_at", place_of(pass)}};
}

Json resource_json(const FrameGraph::ResourceData& resource, const std::optional<Schedule::Lifetime>& lifetime)
{
    const bool is_image = resource.desc.kind == ResourceDesc::Kind::image;
    return {{"name", resource.name},
            {"kind", is_image ? "image" : "buffer"},
            {"format", is_image ? Json(shvr::name_of(resource.desc.format)) : Json(nullptr)},
            {"texels", is_image ? numbers(resource.desc.texels) : Json(nullptr)},
            {"bytes", resource.desc.bytes},
            {"imported", resource.imported},
            {"versions", resource.version},
            {"lifetime", lifetime ? Json{{"first_step", lifetime->first_step}, {"last_step", lifetime->last_step}}
                                  : Json(nullptr)}};
}

std::optional<Barrier> barrier_at(const CompiledGraph& compiled, std::optional<size_t> step)
{
    return step ? compiled.steps[*step].barrier : std::nullopt;
}

}  // namespace

std::string to_text(const Barrier& barrier)
{
    return names_of(barrier.from) + " -> " + names_of(barrier.to) + (barrier.memory ? "" : " (order only)");
}

std::string to_graphviz(const FrameGraph& graph, const CompiledGraph& compiled)
{
    const Schedule schedule(graph, compiled);
    std::string text =
        "digraph frame {\n"
        "    node [fontname=\"Helvetica\", fontsize=10];\n"
        "    edge [fontname=\"Helvetica\", fontsize=9];\n";
    for (size_t i = 0; i < graph.resources().size(); ++i)
        text += resource_node(i, graph.resources()[i], schedule.lifetimes[i]);
    std::vector<bool> is_placed(graph.resources().size());
    for (size_t i = 0; i < graph.passes().size(); ++i) {
        const PassData& pass = graph.passes()[i];
        const std::optional<size_t> step = schedule.step_of_pass[i];
        text += pass_node(i, pass, step, barrier_at(compiled, step));
        const std::string look = step ? "" : std::string(", ") + CULLED;
        for (const Binding& binding : pass.bindings) {
            const std::string label = " [label=" + quoted({binding.name}) + look;
            if (binding.reads) text += sentence("    resource", binding.resource, " -> pass", i, label, "];\n");
            // An edge back up to a resource would disturb the layout, so constraint=false excludes it from the ranking.
            const char* const ending = binding.reads || is_placed[binding.resource] ? ", constraint=false];\n" : "];\n";
            if (binding.writes) text += sentence("    pass", i, " -> resource", binding.resource, label, ending);
            is_placed[binding.resource] = true;
        }
    }
    // Invisible edges arrange the passes from top to bottom in the order of execution.
    for (size_t step = 0; step + 1 < compiled.steps.size(); ++step)
        text += sentence("    pass", compiled.steps[step].pass, " -> pass", compiled.steps[step + 1].pass,
                         " [style=invis];\n");
    return text + "}\n";
}

std::string to_json_text(const FrameGraph& graph, const CompiledGraph& compiled)
{
    const Schedule schedule(graph, compiled);
    Json passes = Json::array();
    for (size_t i = 0; i < graph.passes().size(); ++i) {
        const std::optional<size_t> step = schedule.step_of_pass[i];
        passes.push_back(pass_json(graph, graph.passes()[i], step, barrier_at(compiled, step)));
    }
    Json resources = Json::array();
    for (size_t i = 0; i < graph.resources().size(); ++i)
        resources.push_back(resource_json(graph.resources()[i], schedule.lifetimes[i]));
    const Json text{{"passes", passes}, {"resources", resources}};
    return text.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace shvr
