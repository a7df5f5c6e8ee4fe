#include "haptics/replay/trace.h"

#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>

#include "engine/base/file.h"
#include "engine/base/json.h"
#include "haptics/replay/trace_end.h"

namespace shvr {
namespace {

constexpr int32_t MAX_PLACE = 1 << 30;  ///< voxels
constexpr int64_t MAX_TIME_NS = int64_t{1} << 62;
constexpr double MAX_LENGTH = 1e12;
constexpr const char* PLACE = "three numbers, or \"nan\", \"inf\", \"-inf\"";

// ---- Reading ---------------------------------------------------------------------------------------------------------

double number_or_word(const JsonNode& node, const char* expected)
{
    if (node.is("nan")) return std::numeric_limits<double>::quiet_NaN();
    if (node.is("inf")) return std::numeric_limits<double>::infinity();
    if (node.is("-inf")) return -std::numeric_limits<double>::infinity();
    if (!node.is_number()) node.refuse(expected);
    return node.number(any_number());
}

glm::dvec3 place_of(const JsonNode& node)
{
    const std::vector<JsonNode> parts = node.elements(3, 3);
    return {number_or_word(parts[0], PLACE), number_or_word(parts[1], PLACE), number_or_word(parts[2], PLACE)};
}

uint32_t number_32(const JsonNode& node, uint32_t fallback)
{
    return uint32_t(node.whole(fallback, 0, std::numeric_limits<uint32_t>::max()));
}

void read_caps(const JsonNode& node, DeviceCaps& caps)
{
    node.allow({"usable_lower_m", "usable_upper_m", "peak_force_n", "continuous_force_n", "stiffness_limit",
                "latency_s", "senses_rotation", "outputs_force", "tells_force_sequence"});
    const NumberRange reach{-MAX_REACH_M, MAX_REACH_M}, force{0.0, 1000.0};
    caps.usable_lower_m = node["usable_lower_m"].vector(caps.usable_lower_m, reach);
    caps.usable_upper_m = node["usable_upper_m"].vector(caps.usable_upper_m, reach);
    caps.peak_force_n = node["peak_force_n"].number(caps.peak_force_n, force);
    caps.continuous_force_n = node["continuous_force_n"].number(caps.continuous_force_n, force);
    caps.stiffness_limit = node["stiffness_limit"].number(caps.stiffness_limit, {0.0, 1e6});
    caps.latency_s = node["latency_s"].number(caps.latency_s, {0.0, 1.0});
    caps.senses_rotation = node["senses_rotation"].flag(caps.senses_rotation);
    caps.outputs_force = node["outputs_force"].flag(caps.outputs_force);
    caps.tells_force_sequence = node["tells_force_sequence"].flag(caps.tells_force_sequence);
}

/// Returns whether the columns are equally long and at right angles, within rounding. If they are, the inverse is the
/// transpose divided by the scale squared, on which the force relies.
bool is_rotation_and_scale(const glm::dmat3& matrix)
{
    constexpr double ROUNDING = 1e-6;
    const glm::dmat3 product = glm::transpose(matrix) * matrix;
    const double scale = product[0][0];
    if (!(scale > 0.0)) return false;
    for (glm::length_t i = 0; i < 3; ++i)
        for (glm::length_t j = 0; j < 3; ++j)
            if (!(std::abs(product[i][j] - (i == j ? scale : 0.0)) <= ROUNDING * scale)) return false;
    return true;
}

void read_workspace(const JsonNode& node, Workspace& workspace)
{
    const NumberRange length{-MAX_LENGTH, MAX_LENGTH};
    if (const JsonNode matrix = node["to_volume"]; matrix.exists()) {
        const std::vector<JsonNode> numbers = matrix.elements(9, 9);
        for (size_t i = 0; i < 9; ++i)
            workspace.to_volume[glm::length_t(i / 3)][glm::length_t(i % 3)] = numbers[i].number(length);
        if (!is_rotation_and_scale(workspace.to_volume))
            matrix.refuse("nine numbers of a rotation times a scale, three columns of one length at right angles");
    }
    workspace.origin = node["origin"].vector(workspace.origin, length);
}

void read_settings(const JsonNode& node, TraceSettings& settings)
{
    node.allow({"assistance", "law", "mode", "threshold", "probe_radius", "stiffness", "damping", "to_volume", "origin",
                "reset", "to_camera", "surface_share", "movement_scale", "strength", "clicks", "let_go",
                "relevance_settings"});
    ForceSettings& force = settings.force;
    force.assistance = node["assistance"].flag(force.assistance);
    force.law = node["law"].choice_or(force.law);
    force.mode = node["mode"].choice_or(force.mode);
    settings.threshold = node["threshold"].number(settings.threshold, any_number());
    force.probe_radius = node["probe_radius"].number(force.probe_radius, above_zero(1e-12, MAX_LENGTH));
    force.stiffness = node["stiffness"].number(force.stiffness, {0.0, 1e6});
    force.damping = node["damping"].number(force.damping, {0.0, 1000.0});
    read_workspace(node, force.workspace);
    force.reset = number_32(node["reset"], force.reset);
    force.to_camera = node["to_camera"].vector(force.to_camera, {-1.0, 1.0});
    constexpr double ROUNDING = 1e-6;
    if (!(std::abs(glm::length(force.to_camera) - 1.0) <= ROUNDING))
        node["to_camera"].refuse("a direction, three numbers with a length of 1");
    force.surface_share = node["surface_share"].number(force.surface_share, {0.0, 1.0});
    force.movement_scale = node["movement_scale"].number(force.movement_scale, above_zero(1e-6, 1e6));
    force.strength = node["strength"].number(force.strength, {0.0, 1.0});
    force.clicks = node["clicks"].flag(force.clicks);
    force.let_go = node["let_go"].flag(force.let_go);
    force.relevance_settings = number_32(node["relevance_settings"], force.relevance_settings);
}

glm::ivec3 voxels_of(const JsonNode& node, int32_t least)
{
    const std::vector<JsonNode> parts = node.elements(3, 3);
    const auto part = [&](size_t i) { return int32_t(parts[i].whole(least, MAX_PLACE)); };
    return {part(0), part(1), part(2)};
}

TraceRelevance relevance_of(const JsonNode& node)
{
    node.allow({"sequence", "origin", "size", "words_per_row", "spacing", "volume_size", "level", "settings", "limits",
                "runs"});
    TraceRelevance noted;
    noted.sequence = uint64_t(node["sequence"].whole(1, MAX_TIME_NS));
    noted.origin = voxels_of(node["origin"], 0);
    noted.size = voxels_of(node["size"], 1);
    noted.words_per_row = int32_t(node["words_per_row"].whole(1, RelevancePatch::MAX_VOXELS));
    noted.spacing = node["spacing"].vector(above_zero(1e-12, MAX_LENGTH));
    noted.volume_size = voxels_of(node["volume_size"], 1);
    noted.level = int32_t(node["level"].whole(0, 0, 30));
    noted.settings = number_32(node["settings"], 0);
    noted.limits = number_32(node["limits"], 0);
    noted.runs = node["runs"].text();
    return noted;
}

TraceTick read_tick(const JsonNode& node, const TraceTick* before, uint64_t period_ns)
{
    node.allow({"now", "read", "time", "sequence", "force_sequence", "buttons", "jump", "at", "turn", "calibrated",
                "force", "relevance_time"});
    TraceTick tick;
    if (before) tick.state = before->state, tick.relevance_time_ns = before->relevance_time_ns;
    const uint64_t due_ns = before ? before->now_ns + period_ns : period_ns;
    tick.now_ns = uint64_t(node["now"].whole(int64_t(due_ns), before ? int64_t(before->now_ns) : 0, MAX_TIME_NS));
    if (node["read"].exists()) tick.read = ReadResult(node["read"].choice(TRACE_READS));
    DeviceState& state = tick.state;
    const bool is_fresh = tick.read == ReadResult::fresh;
    state.time_ns = uint64_t(node["time"].whole(int64_t(is_fresh ? tick.now_ns : state.time_ns), 0, MAX_TIME_NS));
    state.sequence = number_32(node["sequence"], state.sequence + (is_fresh ? 1 : 0));
    state.force_sequence = number_32(node["force_sequence"], state.force_sequence);
    state.buttons = number_32(node["buttons"], state.buttons);
    state.jump = number_32(node["jump"], state.jump);
    if (node["at"].exists()) state.position_m = place_of(node["at"]);
    if (const JsonNode turn = node["turn"]; turn.exists()) {
        const std::vector<JsonNode> parts = turn.elements(4, 4);
        const auto part = [&](size_t i) { return number_or_word(parts[i], "a number, or \"nan\", \"inf\", \"-inf\""); };
        state.rotation = glm::dquat(part(0), part(1), part(2), part(3));
    }
    state.calibrated = node["calibrated"].flag(state.calibrated);
    if (node["force"].exists()) tick.force_n = node["force"].vector(any_number());
    tick.relevance_time_ns = uint64_t(node["relevance_time"].whole(int64_t(tick.relevance_time_ns), 0, MAX_TIME_NS));
    return tick;
}

/// Reads the first line. Returns whether the file must have an end line.
bool read_head(const JsonNode& node, Trace& trace)
{
    node.allow({"shvr_stylus_trace", "holds_relevance", "feels_seen", "unit", "rate_hz", "caps"});
    const JsonNode version = node.required("shvr_stylus_trace", "1, 2 or 3, the version of the format");
    const std::string number = version.is_number() ? version.dump() : "";
    if (number != "1" && number != "2" && number != "3")
        version.refuse("1, 2 or 3, the versions that this program reads");
    const JsonNode holds = node["holds_relevance"];
    if (holds.exists() && number != "3") holds.refuse_because("is of version 3; expected that version");
    trace.holds_relevance = holds.flag(number != "1");
    trace.feels_seen = node["feels_seen"].flag(false);
    if (node["unit"].exists()) trace.unit = node["unit"].any_text();
    trace.rate_hz = uint32_t(node["rate_hz"].whole(trace.rate_hz, 1, 100'000));
    if (node["caps"].exists()) read_caps(node["caps"], trace.caps);
    return number == "3";
}

/// Reads the lines after the head. Runs of relevance are decoded here, so that error messages can name their line.
class LineReader {
public:
    explicit LineReader(Trace& trace) : trace_(trace) {}
    void read_first(const JsonNode& node) { has_end_ = read_head(node, trace_); }
    bool has_end() const { return has_end_; }
    void read(const JsonNode& node)
    {
        if (const JsonNode chosen = node["settings"]; chosen.exists()) {
            node.allow({"settings"});
            add_settings(chosen);
        } else if (const JsonNode noted = node["relevance"]; noted.exists()) {
            node.allow({"relevance"});
            add_relevance(noted);
        } else if (const JsonNode device = node["device"]; device.exists()) {
            node.allow({"device"});
            if (!device.is("swapped")) device.refuse("\"swapped\"");
            if (!has_end_) node.refuse_because("is of version 3; expected that version in the head");
            swap_device();
        } else if (const JsonNode caps = node["caps"]; caps.exists()) {
            node.allow({"caps"});
            TraceCaps later{trace_.later_caps.empty() ? trace_.caps : trace_.later_caps.back().caps,
                            trace_.ticks.size()};
            read_caps(caps, later.caps);
            trace_.later_caps.push_back(later);
        } else {
            add_tick(node);
        }
    }

private:
    void add_tick(const JsonNode& node)
    {
        if (trace_.ticks.size() >= MAX_TRACE_TICKS)
            node.refuse_because(sentence("is a tick too many; expected at most ", MAX_TRACE_TICKS));
        if (const JsonNode time = node["relevance_time"]; time.exists() && !knows_relevance_)
            time.refuse("a relevance before it");
        const bool is_other = !trace_.swaps.empty() && trace_.swaps.back() == trace_.ticks.size();
        trace_.ticks.push_back(
            read_tick(node, trace_.ticks.empty() ? nullptr : &trace_.ticks.back(), 1'000'000'000 / trace_.rate_hz));
        // The first tick of another device has no relevance, unless the tick's line states a relevance time.
        if (is_other && !node["relevance_time"].exists()) trace_.ticks.back().relevance_time_ns = 0;
    }
    void swap_device()
    {
        trace_.swaps.push_back(trace_.ticks.size());
        knows_relevance_ = false;
        if (last_) last_->sequence = 0;
    }
    void add_settings(const JsonNode& chosen)
    {
        TraceSettings settings;
        if (!trace_.settings.empty()) settings = trace_.settings.back();
        settings.from_tick = trace_.ticks.size();
        read_settings(chosen, settings);
        trace_.settings.push_back(settings);
    }
    void add_relevance(const JsonNode& node)
    {
        if (!trace_.holds_relevance)
            node.refuse_because("is of a trace that holds relevance; expected version 2 or 3, and \"holds_relevance\"");
        TraceRelevance noted = relevance_of(node);
        if (!last_) last_ = std::make_unique<RelevancePatch>(), next_ = std::make_unique<RelevancePatch>();
        if (noted.sequence <= last_->sequence) node["sequence"].refuse("a number above that of the relevance before");
        if (!read_relevance(noted, *last_, *next_)) node["runs"].refuse("runs that fill its words");
        last_.swap(next_);
        noted.from_tick = trace_.ticks.size();
        knows_relevance_ = true;
        trace_.relevance.push_back(std::move(noted));
    }

    Trace& trace_;
    bool has_end_ = false, knows_relevance_ = false;
    std::unique_ptr<RelevancePatch> last_, next_;
};

}  // namespace

Trace parse_trace(const std::string& whole, const std::string& origin)
{
    Trace trace;
    LineReader reader(trace);
    std::string_view text = whole;
    size_t number = 0;
    bool has_head = false;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find('\n', begin), text.size());
        const std::string_view line = text.substr(begin, end - begin);
        begin = end + 1;
        ++number;
        if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
        const JsonDocument document(line, sentence(origin, ":", number));
        if (std::exchange(has_head, true)) {
            reader.read(document.root());
            continue;
        }
        reader.read_first(document.root());
        // Checks the hash before reading the lines, so that damage to the file is not reported as an error in a line.
        if (reader.has_end()) text = without_trace_end(text, origin);
    }
    if (!has_head) fail(origin, " is empty; expected a line {\"shvr_stylus_trace\":1}");
    if (trace.ticks.empty()) fail(origin, " has no tick; expected lines such as {\"at\":[0.001,0,0]}");
    if (trace.settings.empty() || trace.settings.front().from_tick > 0)
        trace.settings.insert(trace.settings.begin(), TraceSettings{});
    return trace;
}

Trace read_trace(const std::filesystem::path& file)
{
    return parse_trace(read_text(file, MAX_TRACE_BYTES), file.string());
}

}  // namespace shvr
