// shvr haptics: the sense of touch without a window. Needs no Vulkan device, and only `devices` looks for hardware.

#include <algorithm>
#include <cmath>

#include "engine/annotation/work/work_offsets.h"
#include "engine/base/text.h"
#include "engine/volume/pyramid_source.h"
#include "engine/volume/unit.h"
#include "engine/workbench/touch/felt_relevance.h"
#include "haptics/replay/replay.h"
#include "haptics/servo.h"
#include "tools/cli/cli.h"
#include "tools/cli/haptics_report.h"

namespace shvr::cli {

namespace {

struct ReplayCommandOptions {
    Common common;
    std::string trace, volume, mode, law, model;
    std::optional<double> threshold, stiffness, damping;
    uint32_t seed = 1;
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

/// Returns the session's limits of the voxels that are felt. In traces of older programs hidden voxels are felt, too.
FeltLimits limits_of(const ReplayCommandOptions& options, const Trace& trace, const UnmeasuredSession& opened,
                     LongWork& work)
{
    const FeelSettings& touch = opened.session.probe.touch;
    if (!trace.feels_seen || touch.feels_hidden) return limits_of_groups(touch.groups);
    // How intensities look may depend on the values of all voxels, so the volume is measured here.
    OpenedSession measured = open_session(options.volume, options.common.settings,
                                          {.measure = {.progress = work.begin("measuring " + options.volume)}});
    const VolumeInfo& info = measured.source->info();
    const auto lowest = std::ranges::min_element(trace.settings, {}, &TraceSettings::threshold);
    measured.session.probe.haptic_threshold = lowest->threshold;
    return ui::felt_limits(measured.session, camera_named(measured.session, measured.session.camera_name, info), info,
                           window_for(info.type, measured.statistics));
}

/// Returns the density offsets and, if paint decides which voxels are felt, the paint.
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

/// Makes coarser levels if the trace needs them and the file has none: a large ball is felt on coarser levels at some
/// sizes and speeds.
std::shared_ptr<const VolumeSource> with_levels_for(const Trace& trace, std::shared_ptr<const VolumeSource> source,
                                                    LongWork& work)
{
    constexpr uint64_t HOST_BYTES = uint64_t{1} << 30;  // as elsewhere without --budget-host
    const glm::dvec3 spacing = source->info().spacing;
    const double finest = std::min({spacing.x, spacing.y, spacing.z});
    const bool needs_levels = std::ranges::any_of(trace.settings, [&](const TraceSettings& settings) {
        return settings.force.probe_radius / finest > 2.0 * RelevancePlace::MIN_COARSE_RADIUS;
    });
    return needs_levels ? with_levels(std::move(source), HOST_BYTES, work.begin("making coarser levels")) : source;
}

/// Returns a function that computes relevance as the window's mirror does. A trace without a unit gets the volume's.
MakeRelevance relevance_of(const ReplayCommandOptions& options, Trace& trace, LongWork& work)
{
    const UnmeasuredSession opened = open_unmeasured_session(options.volume, options.common.settings);
    const VolumeInfo info = opened.source->info();
    warn(info.warnings, options.common);
    if (!trace.unit.empty() && trace.unit != info.unit)
        fail(options.trace, ": key unit is ", in_quotes(trace.unit), ", and lengths of ", options.volume, " are in ",
             in_quotes(info.unit), "; expected a trace of this volume");
    trace.unit = info.unit;
    const FeltLimits limits = limits_of(options, trace, opened, work);
    const auto document = std::make_shared<const Document>(felt_document(options, opened, info, limits));
    const std::shared_ptr<const VolumeSource> source =
        with_offsets(with_levels_for(trace, opened.source, work), document->density);
    return [source, document, limits, &work](const RegionWish& wish, double threshold, RelevancePatch& patch) {
        work.stop_if_asked();
        ui::host_relevance(*source, &document->mask, limits, wish, threshold, patch);
    };
}

void run_replay(const ReplayCommandOptions& options)
{
    LongWork work(options.common.quiet);
    static_cast<void>(work.begin("reading " + options.trace));
    Trace trace = read_trace(options.trace);
    if (options.threshold)
        for (TraceSettings& settings : trace.settings) settings.threshold = *options.threshold;

    ReplayOptions how{.mode = chosen<TouchMode>(options.mode),
                      .law = chosen<ProxyLaw>(options.law),
                      .stiffness = options.stiffness,
                      .damping = options.damping,
                      .touch = std::nullopt};
    if (!options.model.empty()) how.touch = TouchModel{.seed = options.seed};
    how.relevance_anew = options.threshold.has_value();
    if (options.volume.empty() && !replays_relevance(trace, how))
        fail(options.trace, ": --volume is not given, and ",
             trace.holds_relevance ? "another threshold or device" : "a trace without relevance",
             " needs it; expected the scan that the trace is of");
    const MakeRelevance make = options.volume.empty() ? MakeRelevance() : relevance_of(options, trace, work);
    static_cast<void>(work.begin("replaying " + options.trace));
    const ReplayResult result = replay_trace(trace, how, make);
    clear_progress();
    const TraceSettings& last = trace.settings.back();
    Json report = report_of(result, trace.unit);
    report["mode"] = spelled(how.mode.value_or(last.force.mode));
    report["law"] = spelled(how.law.value_or(last.force.law));
    report["relevance"] = result.is_recorded ? "recorded" : "made";
    report["device_swaps"] = result.swaps;
    report["device_model"] = options.model.empty() ? Json(nullptr) : Json(options.model);
    if (options.common.json) return print(report);
    say(options.common, sentence(result.ticks, " ticks, ", result.late, " late; largest force ", result.largest_force_n,
                                 " N; the hand gained ", 1e3 * result.energy_j, " mJ; proxy ", result.proxy_rms, " ",
                                 trace.unit, " from the probe, root mean square over ", result.contact_ticks,
                                 " ticks of contact; relevance ", result.is_recorded ? "recorded" : "made"));
    if (result.told > 0)
        say(options.common, sentence(result.told_equal, " of ", result.told, " forces equal those of the trace"));
}

void add_replay(CLI::App& haptics)
{
    auto options = std::make_shared<ReplayCommandOptions>();
    CLI::App* command = haptics.add_subcommand("replay", "Runs a stylus trace through the servo's force law");
    command->add_option("TRACE", options->trace, "Stylus trace (JSON lines: haptics/replay/README.md)")->required();
    command->add_option("--volume", options->volume,
                        "Volume, project folder or session (.json); not needed where the trace holds what was felt, "
                        "as those recorded in the window do");
    command->add_option("--mode", options->mode, "Instead of the trace's")->check(CLI::IsMember(choices<TouchMode>()));
    command->add_option("--law", options->law, "Instead of the trace's")->check(CLI::IsMember(choices<ProxyLaw>()));
    command->add_option("--threshold", options->threshold,
                        "Intensity, instead of the trace's; what is felt is made anew");
    command->add_option("--stiffness", options->stiffness, "N/m, instead of the trace's")->check(CLI::Range(0.0, 1e6));
    command->add_option("--damping", options->damping, "N s/m, instead of the trace's")->check(CLI::Range(0.0, 1000.0));
    command
        ->add_option("--device-model", options->model,
                     "A modelled device in a hand that is drawn along the trace; without it, the trace's answers")
        ->check(CLI::IsMember({"touch"}));
    command->add_option("--seed", options->seed, "Of the model's jitter")->capture_default_str();
    add_input_options(*command, options->common);
    add_belief_option(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr haptics replay stroke.trace --volume scan.json --mode object "
        "--device-model touch");
    command->callback([options] { run_replay(*options); });
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
