// shvr haptics: the sense of touch without a window. Needs no Vulkan device; only `devices` looks for hardware.

#include <algorithm>
#include <cmath>

#include "engine/annotation/work/work_offsets.h"
#include "engine/base/text.h"
#include "engine/volume/levels/pyramid_source.h"
#include "engine/volume/unit.h"
#include "engine/workbench/touch/felt_relevance.h"
#include "haptics/replay/replay.h"
#include "haptics/replay/tick_table.h"
#include "haptics/servo.h"
#include "tools/cli/cli.h"
#include "tools/cli/haptics_report.h"

namespace shvr::cli {

namespace {

struct ReplayCommandOptions {
    Common common;
    std::string trace, volume, mode, law, model, csv;
    std::optional<double> threshold, stiffness, damping, radius_voxels, share, strength, latency_ms;
    std::vector<int> groups;
    TouchModel touch;
};

template <class Value>
std::optional<Value> chosen(const std::string& text)
{
    for (const Spelling<Value>& each : spellings_of(Value{}))
        if (each.name == text) return each.value;
    return std::nullopt;
}

template <class Value>
std::vector<std::string> choices()
{
    std::vector<std::string> names;
    for (const Spelling<Value>& each : spellings_of(Value{})) names.emplace_back(each.name);
    return names;
}

/// Returns the session's limits on the voxels that are felt. With traces of older programs, hidden voxels are felt too.
FeltLimits limits_of(const ReplayCommandOptions& options, const Trace& trace, const UnmeasuredSession& opened,
                     LongWork& work)
{
    const FeelSettings& touch = opened.session.probe.touch;
    if (!trace.feels_seen || touch.feels_hidden) return limits_of_groups(touch.groups);
    // Whether an intensity is visible may depend on the values of all voxels, so the volume's statistics are needed.
    OpenedSession measured = open_session(options.volume, options.common.settings,
                                          {.measure = {.progress = work.begin("measuring " + options.volume)}});
    const VolumeInfo& info = measured.source->info();
    const auto lowest = std::ranges::min_element(trace.settings, {}, &TraceSettings::threshold);
    measured.session.probe.haptic_threshold = lowest->threshold;
    return ui::felt_limits(measured.session, camera_named(measured.session, measured.session.camera_name, info), info,
                           window_for(info.type, measured.statistics));
}

/// Returns the density offsets and, if the limits depend on paint, also the mask.
Document felt_document(const ReplayCommandOptions& options, const UnmeasuredSession& opened, const VolumeInfo& info,
                       const FeltLimits& limits)
{
    if (!limits.need_mask()) {
        std::vector<Notice> notices;
        DensityField offsets = offsets_of(work_files(opened.session, info), options.common.belief, notices);
        warn(notices, options.common);
        return {.mask = Mask(info.size), .trace = {}, .density = std::move(offsets)};
    }
    Work work(info.size, info.type);
    warn(work.open(work_files(opened.session, info), {.belief = options.common.belief, .only_look = true}),
         options.common);
    work.expect_choice();
    return work.document();
}

/// Adds coarser levels to the volume if the trace needs them and the file has none: a large ball is felt on coarser
/// levels at some sizes and speeds.
std::shared_ptr<const VolumeSource> with_levels_for(const Trace& trace, const ReplayOptions& how,
                                                    std::shared_ptr<const VolumeSource> source, LongWork& work)
{
    constexpr uint64_t HOST_BYTES = uint64_t{1} << 30;  // as elsewhere without --budget-host
    const glm::dvec3 spacing = source->info().spacing;
    const double finest = std::min({spacing.x, spacing.y, spacing.z});
    const bool needs_levels = std::ranges::any_of(trace.settings, [&](const TraceSettings& settings) {
        const double radius = how.probe_radius.value_or(settings.force.probe_radius);
        return radius / finest > 2.0 * RelevancePlace::MIN_COARSE_RADIUS;
    });
    return needs_levels ? with_levels(std::move(source), HOST_BYTES, work.begin("making coarser levels")) : source;
}

/// Relevance that is computed from the volume; `make` is empty where the trace's own is used.
struct MadeRelevance {
    MakeRelevance make{};
    std::vector<uint8_t> groups{};  ///< that are felt; empty: all
};

/// Returns a function that computes relevance as the window's mirror does. Sets the unit of a trace without one to the
/// volume's unit; a radius in voxels is converted to that unit.
MadeRelevance relevance_of(const ReplayCommandOptions& options, Trace& trace, ReplayOptions& how, LongWork& work)
{
    const UnmeasuredSession opened = open_unmeasured_session(options.volume, options.common.settings);
    const VolumeInfo info = opened.source->info();
    warn(info.warnings, options.common);
    if (!trace.unit.empty() && trace.unit != info.unit)
        fail(options.trace, ": key unit is ", in_quotes(trace.unit), ", and lengths of ", options.volume, " are in ",
             in_quotes(info.unit), "; expected a trace of this volume");
    trace.unit = info.unit;
    if (options.radius_voxels) how.probe_radius = *options.radius_voxels * info.spacing.x;
    const FeltLimits limits = limits_of(options, trace, opened, work);
    const auto document = std::make_shared<const Document>(felt_document(options, opened, info, limits));
    const std::shared_ptr<const VolumeSource> source =
        with_offsets(with_levels_for(trace, how, opened.source, work), document->density);
    return {.make =
                [source, document, limits, &work](const RegionWish& wish, double threshold, RelevancePatch& patch) {
                    work.stop_if_asked();
                    ui::host_relevance(*source, &document->mask, limits, wish, threshold, patch);
                },
            .groups = opened.session.probe.touch.groups};
}

/// Returns the replay's options except the radius, whose conversion needs the volume's spacing.
ReplayOptions replay_options(const ReplayCommandOptions& options)
{
    ReplayOptions how{.mode = chosen<TouchMode>(options.mode),
                      .law = chosen<ProxyLaw>(options.law),
                      .stiffness = options.stiffness,
                      .damping = options.damping,
                      .surface_share = options.share,
                      .strength = options.strength};
    if (!options.model.empty()) how.touch = options.touch;
    how.relevance_anew = options.threshold || options.radius_voxels || options.latency_ms || !options.groups.empty();
    if (options.latency_ms) how.relevance_latency_s = 1e-3 * *options.latency_ms;
    return how;
}

/// Adds the settings in effect in the last tick to the report.
void add_settings(const ReplayCommandOptions& options, const Trace& trace, const ReplayOptions& how,
                  const ReplayResult& result, const MadeRelevance& made, Json& report)
{
    const bool is_recorded = result.is_recorded;
    const ForceSettings& last = trace.settings.back().force;
    report["mode"] = spelled(how.mode.value_or(last.mode));
    report["law"] = spelled(how.law.value_or(last.law));
    report["probe_radius"] = how.probe_radius.value_or(last.probe_radius);
    report["surface_share"] = how.surface_share.value_or(last.surface_share);
    report["strength"] = how.strength.value_or(last.strength);
    report["relevance"] = is_recorded ? "recorded" : "made";
    report["latency_ms"] = is_recorded ? Json(nullptr) : Json(1e3 * how.relevance_latency_s);
    report["assisted_ticks"] = result.assisted_ticks;
    report["groups"] = is_recorded || made.groups.empty() ? Json(nullptr) : Json(made.groups);
    report["device_model"] = options.model.empty() ? Json(nullptr) : Json(options.model);
    if (!options.model.empty())
        report["hand"] = {{"mass_kg", options.touch.hand_kg},
                          {"stiffness_n_per_m", options.touch.hand_stiffness},
                          {"damping_n_s_per_m", options.touch.hand_damping}};
    report["csv"] = options.csv.empty() ? Json(nullptr) : Json(options.csv);
}

void check_csv(const ReplayCommandOptions& options)
{
    check_output("--csv", options.csv, {".csv"});
    if (options.csv.empty()) return;
    check_output_is_not(options.trace, options.csv);
    if (!options.volume.empty()) check_output_is_not(options.volume, options.csv);
}

void run_replay(const ReplayCommandOptions& options)
{
    check_csv(options);
    LongWork work(options.common.quiet);
    static_cast<void>(work.begin("reading " + options.trace));
    Trace trace = read_trace(options.trace);
    if (options.threshold)
        for (TraceSettings& settings : trace.settings) settings.threshold = *options.threshold;

    ReplayOptions how = replay_options(options);
    if (options.volume.empty() && !replays_relevance(trace, how))
        fail(options.trace, ": --volume is not given, and ",
             trace.holds_relevance ? "another threshold, radius, choice of groups, latency or device"
                                   : "a trace without relevance",
             " needs it; expected the scan that the trace is of");
    const MadeRelevance made = options.volume.empty() ? MadeRelevance() : relevance_of(options, trace, how, work);
    static_cast<void>(work.begin("replaying " + options.trace));
    std::optional<TickTable> table;
    if (!options.csv.empty()) {
        table.emplace(written_path(options.csv), trace.unit);
        how.note_tick = [&table](const ReplayedTick& tick) { table->add(tick); };
    }
    const ReplayResult result = replay_trace(trace, how, made.make);
    if (table) table->commit();
    clear_progress();
    Json report = report_of(result, trace.unit);
    add_settings(options, trace, how, result, made, report);
    if (result.assisted_ticks == 0)
        say(options.common, options.trace + ": settings: key assistance is false in all ticks, so no force was " +
                                "computed; expected true in ticks whose forces are wanted");
    report["device_swaps"] = result.swaps;
    if (options.common.json) return print(report);
    say(options.common, sentence(result.ticks, " ticks, ", result.late, " late; largest force ", result.largest_force_n,
                                 " N; the hand gained ", 1e3 * result.energy_j, " mJ; proxy ", result.proxy_rms, " ",
                                 trace.unit, " from the probe, root mean square over ", result.contact_ticks,
                                 " ticks of contact; relevance ", result.is_recorded ? "recorded" : "made"));
    if (result.told > 0)
        say(options.common, sentence(result.told_equal, " of ", result.told, " forces equal those of the trace"));
    if (table) say(options.common, options.csv + ": a line for each tick");
}

/// Options that replace the trace's settings.
void add_overrides(CLI::App& command, ReplayCommandOptions& options)
{
    command.add_option("--mode", options.mode, "Instead of the trace's")->check(CLI::IsMember(choices<TouchMode>()));
    command.add_option("--law", options.law, "Instead of the trace's")->check(CLI::IsMember(choices<ProxyLaw>()));
    command.add_option("--threshold", options.threshold, "Intensity, instead of the trace's; relevance is made again");
    command
        .add_option("--radius", options.radius_voxels,
                    "Radius of the probe, in voxels along x, instead of the trace's; relevance is made again")
        ->check(number_between(0.01, 1e6));
    command
        .add_option("--share", options.share, "Share of the ball above which a surface holds, instead of the trace's")
        ->check(number_between(0.01, 1.0));
    command.add_option("--strength", options.strength, "Factor of the force, 0 to 1, instead of the trace's")
        ->check(number_between(0.0, 1.0));
    command.add_option("--stiffness", options.stiffness, "N/m, instead of the trace's")
        ->check(number_between(0.0, 1e6));
    command.add_option("--damping", options.damping, "N s/m, instead of the trace's")
        ->check(number_between(0.0, 1000.0));
    command
        .add_option("--groups", options.groups,
                    "Groups that are felt, 0 for unpainted voxels, instead of the session's "
                    "probe.touch.groups; relevance is made again")
        ->delimiter(',')
        ->check(CLI::Range(0, 255));
    command
        .add_option("--latency", options.latency_ms,
                    "Milliseconds from a request for relevance until it is felt; 24 as in the window; relevance is "
                    "made again")
        ->check(number_between(0.0, 10000.0));
}

/// The modelled device and its hand.
void add_model_options(CLI::App& command, ReplayCommandOptions& options)
{
    TouchModel& touch = options.touch;
    CLI::Option* const model =
        command
            .add_option("--device-model", options.model,
                        "A modelled device in a hand that is drawn along the trace; without it, the trace's answers")
            ->check(CLI::IsMember({"touch"}));
    command.add_option("--seed", touch.seed, "Of the model's jitter")->capture_default_str();
    const auto add = [&](const char* name, double& value, const char* help, double least, double most) {
        command.add_option(name, value, help)->capture_default_str()->check(number_between(least, most))->needs(model);
    };
    add("--hand-mass", touch.hand_kg, "Mass of the modelled hand, kg", 0.0, 10.0);
    add("--hand-stiffness", touch.hand_stiffness, "Stiffness of its grip, N/m; 0: the stylus is let go", 0.0, 1e5);
    add("--hand-damping", touch.hand_damping, "Damping of its grip, N s/m", 0.0, 1000.0);
}

void add_replay(CLI::App& haptics)
{
    auto options = std::make_shared<ReplayCommandOptions>();
    CLI::App* command = haptics.add_subcommand("replay", "Runs a stylus trace through the servo's force law");
    command->add_option("TRACE", options->trace, "Stylus trace (JSON lines: haptics/replay/README.md)")->required();
    command->add_option("--volume", options->volume,
                        "Volume, project folder or session (.json); not needed where the trace holds what was felt, "
                        "as those recorded in the window do");
    add_overrides(*command, *options);
    add_model_options(*command, *options);
    command->add_option("--csv", options->csv,
                        "Write forces, probe, proxy and flags of each tick (columns: haptics/replay/tick_table.h)");
    add_input_options(*command, options->common);
    add_belief_option(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr haptics replay stroke.trace --volume scan.json --mode object "
        "--device-model touch");
    command->callback([options] {
        if (!options->groups.empty()) {
            std::string felt = "probe.touch.groups=[";
            for (const int group : options->groups) felt += std::to_string(group) + ',';
            felt.back() = ']';
            options->common.settings.push_back(felt);
        }
        run_replay(*options);
    });
}

}  // namespace

void add_haptics(CLI::App& program)
{
    CLI::App* haptics = program.add_subcommand("haptics", "The sense of touch: replays, times, lists devices");
    haptics->require_subcommand(1);
    haptics->footer("Example:\n  shvr haptics devices");
    add_replay(*haptics);
    add_haptics_bench(*haptics);
    add_haptics_devices(*haptics);
}

}  // namespace shvr::cli
