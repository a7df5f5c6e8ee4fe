// Writes traces.

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "engine/base/atomic_writer.h"
#include "haptics/replay/trace.h"
#include "haptics/replay/trace_end.h"

namespace shvr {
namespace {

constexpr uint64_t VERSION = 3;

struct Line {
    std::string text = "{";
    bool is_first = true;

    void key(std::string_view name)
    {
        text += is_first ? "\"" : ",\"";
        is_first = false;
        text += name;
        text += "\":";
    }
    void put(double value)
    {
        if (!std::isfinite(value)) {
            text += std::isnan(value) ? "\"nan\"" : value > 0.0 ? "\"inf\"" : "\"-inf\"";
            return;
        }
        char digits[40];
        const auto end = std::to_chars(digits, digits + sizeof(digits), value).ptr;
        text.append(digits, end);
    }
    void add(std::string_view name, double value) { key(name), put(value); }
    void add(std::string_view name, uint64_t value) { key(name), text += std::to_string(value); }
    void add(std::string_view name, uint32_t value) { add(name, uint64_t(value)); }
    void add(std::string_view name, bool value) { key(name), text += value ? "true" : "false"; }
    void add(std::string_view name, std::string_view value) { key(name), text += '"', text += value, text += '"'; }
    void add(std::string_view name, std::initializer_list<double> values)
    {
        key(name);
        char before = '[';
        for (const double value : values) text += std::exchange(before, ','), put(value);
        text += ']';
    }
    void add(std::string_view name, const glm::dvec3& v) { add(name, {v.x, v.y, v.z}); }
    std::string end() { return text + "}"; }
};

std::string in_json(const std::string& text)
{
    std::string safe;
    for (const char c : text)
        if (c != '"' && c != '\\' && static_cast<unsigned char>(c) >= 32) safe += c;
    return safe;
}

std::string line_of(const DeviceCaps& stated)
{
    Line caps;
    caps.add("usable_lower_m", stated.usable_lower_m);
    caps.add("usable_upper_m", stated.usable_upper_m);
    caps.add("peak_force_n", stated.peak_force_n);
    caps.add("continuous_force_n", stated.continuous_force_n);
    caps.add("stiffness_limit", stated.stiffness_limit);
    caps.add("latency_s", stated.latency_s);
    caps.add("senses_rotation", stated.senses_rotation);
    caps.add("outputs_force", stated.outputs_force);
    caps.add("tells_force_sequence", stated.tells_force_sequence);
    return caps.end();
}

std::string head_of(const Trace& trace)
{
    Line head;
    head.add("shvr_stylus_trace", VERSION);
    head.add("holds_relevance", trace.holds_relevance);
    if (trace.feels_seen) head.add("feels_seen", true);
    head.add("unit", std::string_view(in_json(trace.unit)));
    head.add("rate_hz", trace.rate_hz);
    head.key("caps");
    head.text += line_of(trace.caps);
    return head.end();
}

std::string line_of(const TraceSettings& settings)
{
    const ForceSettings& force = settings.force;
    const glm::dmat3& m = force.workspace.to_volume;
    Line line;
    line.add("assistance", force.assistance);
    line.add("law", spelled(force.law));
    line.add("mode", spelled(force.mode));
    line.add("threshold", settings.threshold);
    line.add("probe_radius", force.probe_radius);
    line.add("stiffness", force.stiffness);
    line.add("damping", force.damping);
    line.add("to_volume", {m[0].x, m[0].y, m[0].z, m[1].x, m[1].y, m[1].z, m[2].x, m[2].y, m[2].z});
    line.add("origin", force.workspace.origin);
    line.add("reset", force.reset);
    line.add("to_camera", force.to_camera);
    line.add("surface_share", force.surface_share);
    line.add("movement_scale", force.movement_scale);
    line.add("strength", force.strength);
    if (force.clicks) line.add("clicks", true);  // older programs without clicks refuse the key
    line.add("let_go", force.let_go);
    line.add("relevance_settings", force.relevance_settings);
    return "{\"settings\":" + line.end() + "}";
}

std::string line_of(const TraceRelevance& noted)
{
    const auto whole = [](const glm::ivec3& v) { return glm::dvec3(v); };
    Line line;
    line.add("sequence", noted.sequence);
    line.add("origin", whole(noted.origin));
    line.add("size", whole(noted.size));
    line.add("words_per_row", uint32_t(noted.words_per_row));
    line.add("spacing", noted.spacing);
    line.add("volume_size", whole(noted.volume_size));
    line.add("level", uint32_t(noted.level));
    line.add("settings", noted.settings);
    if (noted.limits != 0) line.add("limits", noted.limits);
    line.add("runs", std::string_view(noted.runs));
    return "{\"relevance\":" + line.end() + "}";
}

std::string line_of(const TraceTick& tick, uint64_t relevance_time_before_ns)
{
    const DeviceState& state = tick.state;
    const glm::dquat& q = state.rotation;
    Line line;
    line.add("now", tick.now_ns);
    if (tick.read != ReadResult::fresh) line.add("read", TRACE_READS[size_t(tick.read)]);
    line.add("time", state.time_ns);
    line.add("sequence", state.sequence);
    line.add("force_sequence", state.force_sequence);
    line.add("at", state.position_m);
    line.add("turn", {q.w, q.x, q.y, q.z});
    line.add("buttons", state.buttons);
    line.add("jump", state.jump);
    line.add("calibrated", state.calibrated);
    if (tick.force_n) line.add("force", *tick.force_n);
    if (tick.relevance_time_ns != relevance_time_before_ns) line.add("relevance_time", tick.relevance_time_ns);
    return line.end();
}

}  // namespace

std::string text_of(const Trace& trace)
{
    std::string text = head_of(trace) + "\n";
    auto swap = trace.swaps.begin();
    auto settings = trace.settings.begin();
    auto caps = trace.later_caps.begin();
    auto relevance = trace.relevance.begin();
    uint64_t relevance_time_ns = 0;
    for (size_t tick = 0; tick < trace.ticks.size(); ++tick) {
        if (swap != trace.swaps.end() && *swap == tick) {
            text += "{\"device\":\"swapped\"}\n";
            relevance_time_ns = 0;
            ++swap;
        }
        for (; caps != trace.later_caps.end() && caps->from_tick <= tick; ++caps)
            text += "{\"caps\":" + line_of(caps->caps) + "}\n";
        for (; relevance != trace.relevance.end() && relevance->from_tick <= tick; ++relevance)
            text += line_of(*relevance) + "\n";
        for (; settings != trace.settings.end() && settings->from_tick <= tick; ++settings)
            text += line_of(*settings) + "\n";
        text +=
            line_of(trace.ticks[tick], std::exchange(relevance_time_ns, trace.ticks[tick].relevance_time_ns)) + "\n";
    }
    return text + trace_end(text);
}

void write_trace(const std::filesystem::path& file, const Trace& trace)
{
    const std::string text = text_of(trace);
    AtomicWriter writer(file);
    writer.append(std::as_bytes(std::span<const char>(text)));
    writer.commit();
}

}  // namespace shvr
