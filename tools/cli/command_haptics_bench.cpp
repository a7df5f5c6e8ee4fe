// shvr haptics bench: measures the cost of a tick, and whether this machine meets the servo's deadlines.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include "engine/base/finite.h"
#include "engine/volume/unit.h"
#include "haptics/servo.h"
#include "tools/cli/haptics_report.h"

namespace shvr::cli {

namespace {

struct BenchCommandOptions {
    Common common;
    double seconds = 2.0;
    std::string sweep, plot;
};

constexpr double SPACING_UM = 10.0;
constexpr int32_t SIDE = 256;  ///< side of the scene in voxels: a winding tube, a second tube near it, 1 % noise

/// A deterministic hash.
uint32_t scattered(uint32_t x)
{
    x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu;
    return x ^ x >> 16;
}

glm::dvec2 middle_of_tube(double x)
{
    return {128.0 + 20.0 * std::sin(x / 25.0), 128.0 + 16.0 * std::cos(x / 30.0)};
}

std::vector<uint8_t> make_scene()
{
    std::vector<uint8_t> scene(size_t(SIDE) * SIDE * SIDE);
    for (int32_t z = 0; z < SIDE; ++z)
        for (int32_t y = 0; y < SIDE; ++y)
            for (int32_t x = 0; x < SIDE; ++x) {
                const size_t at = size_t(x) + size_t(SIDE) * (size_t(y) + size_t(SIDE) * size_t(z));
                const glm::dvec2 away = glm::dvec2(y, z) - middle_of_tube(x);
                const glm::dvec2 other = away - glm::dvec2(11.0, 3.0);
                const bool is_noise = scattered(uint32_t(at)) % 100 == 0;
                scene[at] = glm::dot(away, away) <= 25.0 || glm::dot(other, other) <= 16.0 || is_noise;
            }
    return scene;
}

void cut(const std::vector<uint8_t>& scene, const glm::dvec3& point, int32_t side, RelevancePatch& patch)
{
    patch.origin =
        glm::clamp(glm::ivec3(glm::round(point / SPACING_UM)) - side / 2, glm::ivec3(0), glm::ivec3(SIDE - side));
    patch.size = glm::ivec3(side);
    patch.words_per_row = side / 32;
    patch.spacing = glm::dvec3(SPACING_UM);
    patch.volume_size = glm::ivec3(SIDE);
    std::fill_n(patch.words.begin(), patch.word_count(), 0u);
    for (int32_t z = 0; z < side; ++z)
        for (int32_t y = 0; y < side; ++y)
            for (int32_t x = 0; x < side; ++x) {
                const glm::ivec3 v = patch.origin + glm::ivec3(x, y, z);
                const size_t at = size_t(v.x) + size_t(SIDE) * (size_t(v.y) + size_t(SIDE) * size_t(v.z));
                patch.words[size_t(x / 32 + patch.words_per_row * (y + side * z))] |= uint32_t(scene[at]) << (x % 32);
            }
}

/// Makes a trace of a hand that follows the tube at 20 mm/s and deviates from it like a human hand. A voxel is 0.25 mm.
Trace make_trace(double radius_voxels, TouchMode mode, size_t ticks)
{
    Trace trace;
    trace.unit = "um";
    trace.caps.outputs_force = true;
    TraceSettings settings;
    settings.force.assistance = true;
    settings.force.mode = mode;
    settings.force.probe_radius = radius_voxels * SPACING_UM;
    settings.force.workspace = {glm::dmat3(SPACING_UM / 0.00025), glm::dvec3(SPACING_UM * 128.0)};
    trace.settings.push_back(settings);
    for (size_t i = 0; i < ticks; ++i) {
        const double t = double(i) * 1e-3, x = 70.0 + 40.0 * std::min(t, 2.5);
        const double stray = std::min(t, 1.0) * 4.0 * std::sin(2.0 * std::numbers::pi * 0.8 * t);
        const glm::dvec2 middle = middle_of_tube(x);
        TraceTick tick;
        tick.now_ns = 1'000'000 * (i + 1);
        tick.state.time_ns = tick.now_ns;
        tick.state.sequence = uint32_t(i + 1);
        tick.state.position_m = (glm::dvec3(x, middle.x + stray, middle.y) - 128.0) * 0.00025;
        trace.ticks.push_back(tick);
    }
    return trace;
}

struct Case {
    int32_t side;
    double radius;
    TouchMode mode;
};
constexpr Case CASES[] = {{64, 12.0, TouchMode::object},  {64, 12.0, TouchMode::proximity},
                          {64, 24.0, TouchMode::object},  {64, 12.0, TouchMode::surface},
                          {128, 24.0, TouchMode::object}, {128, 48.0, TouchMode::object}};

Json run_case(const std::vector<uint8_t>& scene, const Case& one, LongWork& work, Json& first)
{
    constexpr size_t TICKS = 1500;
    constexpr uint32_t EVERY = 2;  // every second tick gets new relevance, far more often than in the window
    const Trace trace = make_trace(one.radius, one.mode, TICKS);
    const MakeRelevance make = [&](const RegionWish& wish, double, RelevancePatch& patch) {
        work.stop_if_asked();
        cut(scene, wish.point, one.side, patch);
    };
    const ReplayResult result = replay_trace(trace, {.touch = TouchModel{}, .relevance_every = EVERY}, make);
    Json measured = report_of(result, "um");
    if (first.is_null()) first = measured;
    return {{"side", one.side},
            {"radius_voxels", one.radius},
            {"mode", spelled(one.mode)},
            {"relevance_every", EVERY},
            {"ticks", result.ticks},
            {"tick_us", measured["tick_us"]},
            {"max_force_n", measured["max_force_n"]},
            {"energy_mj", measured["energy_mj"]}};
}

/// Runs the servo on the real clock, with a modelled Touch at rest in the tube.
Json run_servo(const std::vector<uint8_t>& scene, double seconds, LongWork& work)
{
    const Trace trace = make_trace(12.0, TouchMode::object, 1);
    auto device = std::make_unique<ModelledTouch>();
    device->wish().publish({.position_m = trace.ticks[0].state.position_m, .buttons = 0, .jump = 1});
    const auto servo = std::make_unique<Servo>(std::move(device), real_pacing(), Servo::Options{});
    servo->settings().publish(trace.settings[0].force);
    const glm::dvec3 point = trace.settings[0].force.workspace.to_point(trace.ticks[0].state.position_m);
    using Clock = std::chrono::steady_clock;
    uint64_t sequence = 0;
    for (const auto end = Clock::now() + std::chrono::duration<double>(seconds); Clock::now() < end;) {
        work.stop_if_asked();
        RelevancePatch& patch = servo->relevance().writing();
        cut(scene, point, 64, patch);
        patch.sequence = ++sequence;
        patch.time_ns = uint64_t(Clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
        servo->relevance().publish();
        std::this_thread::sleep_for(std::chrono::milliseconds(16));
    }
    servo->state().take();
    const ServoState& state = servo->state().value();
    const auto histogram = [](const TimeHistogram& times) {
        return Json{
            {"p50", times.quantile_us(0.5)}, {"p99", times.quantile_us(0.99)}, {"max", double(times.worst_ns) * 1e-3}};
    };
    return {{"ticks", state.ticks},
            {"late", state.late_ticks},
            {"is_realtime", servo->is_realtime()},
            {"keeps_memory", servo->keeps_memory()},
            {"work_us", histogram(state.duration)},
            {"lateness_us", histogram(state.lateness)}};
}

void run_bench(const BenchCommandOptions& options)
{
    check_output("--sweep", options.sweep, {".csv"});
    check_output("--plot", options.plot, {".svg"});
    LongWork work(options.common.quiet);
    if (!options.sweep.empty()) {
        static_cast<void>(work.begin("timing the proxy"));
        const std::vector<std::string> rows = sweep_proxy(options.sweep, options.plot, work);
        clear_progress();
        if (options.common.json) return print({{"csv", options.sweep}, {"rows", rows.size()}});
        for (const std::string& row : rows) say(options.common, row);
        return;
    }
    static_cast<void>(work.begin("timing the servo"));
    const std::vector<uint8_t> scene = make_scene();
    Json first, cases = Json::array();
    for (const Case& one : CASES) cases.push_back(run_case(scene, one, work, first));
    const Json servo = run_servo(scene, options.seconds, work);
    clear_progress();
    Json report = {{"ticks", servo["ticks"]},
                   {"late", servo["late"]},
                   {"max_force_n", first["max_force_n"]},
                   {"energy_mj", first["energy_mj"]},
                   {"proxy_rms_um", first["proxy_rms_um"]},
                   {"tick_us", first["tick_us"]},
                   {"servo", servo},
                   {"cases", cases}};
    if (options.common.json) return print(report);
    for (const Json& one : cases)
        say(options.common, sentence(one["side"], "^3, ball of ", one["radius_voxels"], " voxels, ",
                                     one["mode"].get<std::string>(), ": p50 ", one["tick_us"]["p50"], ", p99 ",
                                     one["tick_us"]["p99"], ", most ", one["tick_us"]["max"], " us a tick"));
    say(options.common, sentence("servo on the clock: ", servo["ticks"], " ticks, ", servo["late"], " late, ",
                                 servo["is_realtime"].get<bool>() ? "SCHED_FIFO" : "no realtime scheduling", ", ",
                                 servo["keeps_memory"].get<bool>() ? "memory kept" : "memory not kept"));
}

}  // namespace

Json quantiles_us(std::vector<uint64_t> nanoseconds)
{
    if (nanoseconds.empty()) return {{"p50", 0.0}, {"p99", 0.0}, {"max", 0.0}};
    std::ranges::sort(nanoseconds);
    const auto at = [&](double share) {
        const auto place = size_t(std::ceil(share * double(nanoseconds.size())));
        return double(nanoseconds[std::clamp<size_t>(place, 1, nanoseconds.size()) - 1]) * 1e-3;
    };
    return {{"p50", at(0.5)}, {"p99", at(0.99)}, {"max", at(1.0)}};
}

Json report_of(const ReplayResult& result, const std::string& unit)
{
    const std::optional<double> micrometres = micrometres_in(unit);
    char hash[17];
    std::snprintf(hash, sizeof(hash), "%016llx", static_cast<unsigned long long>(result.hash));
    return {{"ticks", result.ticks},
            {"late", result.late},
            {"max_force_n", result.largest_force_n},
            {"max_step_n", result.largest_step_n},
            {"energy_mj", 1e3 * result.energy_j},
            {"proxy_rms_um", micrometres ? Json(result.proxy_rms * *micrometres) : Json(nullptr)},
            {"proxy_rms", result.proxy_rms},
            {"unit", unit},
            {"tick_us", quantiles_us(result.tick_ns)},
            {"contact_ticks", result.contact_ticks},
            {"objects", result.objects},
            {"relevance_made", result.patches},
            {"forces_hash", hash},
            {"forces_told", result.told},
            {"forces_equal", result.told_equal}};
}

void add_haptics_bench(CLI::App& haptics)
{
    auto options = std::make_shared<BenchCommandOptions>();
    CLI::App* command = haptics.add_subcommand("bench", "What a tick costs, and whether the servo keeps time here");
    command->add_option("--seconds", options->seconds, "How long the servo runs on the clock")
        ->check(number_between(0.1, 3600.0))
        ->capture_default_str();
    CLI::Option* sweep = command->add_option(
        "--sweep", options->sweep, "Instead: speed against error of the proxy by points and exactly, to this CSV file");
    command->add_option("--plot", options->plot, "The sweep as a picture, to this SVG file")->needs(sweep);
    add_output_options(*command, options->common);
    command->footer("Example:\n  shvr haptics bench --sweep proxy.csv --plot proxy.svg");
    command->callback([options] { run_bench(*options); });
}

}  // namespace shvr::cli
