#include "tools/cli/profile/profile_session.h"

#include <chrono>
#include <numeric>

#include "engine/annotation/script/script.h"
#include "ui/workbench/workbench.h"

namespace shvr::cli {

namespace {

/// What is counted; an action's share is the difference of two.
struct SessionCounts {
    uint64_t submits = 0, allocations = 0, uploads = 0, evictions = 0;
    int64_t painted = 0;

    SessionCounts(ui::Workbench& bench, Renderer& renderer)
        : submits(bench.screen().submissions()), allocations(renderer.memory().allocations_made())
    {
        const std::array<int64_t, 256> groups = bench.document().annotator.document().mask.voxels_by_group();
        painted = std::accumulate(groups.begin() + 1, groups.end(), int64_t(0));
        if (const auto bricks = renderer.volume().counts()) uploads = bricks->uploads, evictions = bricks->evictions;
    }
};

bool shows_at_least_a_sketch(ui::Workbench& bench)
{
    if (bench.is_stirring()) return false;
    for (const Screen::Part& part : bench.screen().parts())
        if (!part.view->is_sketched()) return false;
    return true;
}

/// Turns until nothing is left to do, and notes when what was reached.
void settle(ui::Workbench& bench, ProfiledAction& action, const std::function<double()>& now_ms)
{
    const auto& annotator = bench.document().annotator;
    for (;;) {
        const double since = now_ms() - action.begin_ms;
        if (!action.paint_ms && !annotator.stroke_is_running()) action.paint_ms = since;
        if (action.paint_ms && !action.sketch_ms && shows_at_least_a_sketch(bench)) action.sketch_ms = since;
        if (action.paint_ms && !action.sharp_ms && !bench.is_stirring() && bench.screen().complete())
            action.sharp_ms = since;
        if (!bench.has_work() || annotator.stroke_is_open()) return;
        bench.advance();
    }
}

}  // namespace

SessionProfile profile_session(const std::string& input, const std::string& script, const Common& common)
{
    std::vector<std::pair<int, ui::Action>> actions;
    for_each_line(script,
                  [&](const JsonNode& line, int number) { actions.emplace_back(number, ui::read_action(line)); });
    if (actions.empty()) fail(script, ": holds no action; expected one JSON object a line, as shvr view --log writes");
    LongWork work(common.quiet);
    const char* validation = std::getenv("SHVR_VALIDATION");
    Renderer renderer({.device = {common.device, validation && *validation == '1'},
                       .budget = {common.budget_device_mib << 20, common.budget_host_mib << 20},
                       .threads = common.threads});
    ui::Workbench bench(renderer, {.has_servo = false});
    static_cast<void>(work.begin("opening " + input));
    bench.open(input, common.settings);
    if (bench.document().only_looks())
        fail(input, ": is open for writing in ", bench.document().holder, "; expected it to be closed there first");
    const gpu::DeviceTraits& traits = renderer.device().traits();
    SessionProfile profile{.input = input,
                           .script = script,
                           .device = traits.name,
                           .driver = traits.driver,
                           .size = bench.document().session.render.size};
    bench.set_pixels(profile.size);
    bench.set_hand_down(true);  // the script says where a step of settings ends
    const auto started = std::chrono::steady_clock::now();
    const auto now_ms = [&] {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
    };
    ProfiledAction opening;  // the first picture is not the first action's
    bench.advance();
    settle(bench, opening, now_ms);

    static_cast<void>(work.begin("replaying " + script));
    const double origin = now_ms();
    const auto since_origin = [&] { return now_ms() - origin; };
    for (const auto& [number, action] : actions) {
        work.show(double(profile.actions.size()) / double(actions.size()), {}, -1.0);
        work.stop_if_asked();
        ProfiledAction one{.line = number, .action = Json::parse(ui::line_of(action)).at("op").get<std::string>()};
        const SessionCounts before(bench, renderer);
        const uint64_t openings = bench.openings();
        one.begin_ms = since_origin();
        try {
            bench.perform(action);
            if (bench.has_work() && !bench.document().annotator.stroke_is_open()) bench.advance();
            settle(bench, one, since_origin);
        } catch (const DeviceLost&) {
            throw;
        } catch (const Error& error) {
            fail(script, ":", number, ": ", error.what());
        }
        if (bench.openings() != openings)
            fail(script, ":", number, ": opens another volume; expected actions on ", input, " alone");
        one.end_ms = since_origin();
        const SessionCounts after(bench, renderer);
        one.submits = after.submits - before.submits;
        one.allocations = after.allocations - before.allocations;
        one.uploads = after.uploads - before.uploads;
        one.evictions = after.evictions - before.evictions;
        one.voxels_painted = after.painted - before.painted;
        if (one.voxels_painted == 0) one.paint_ms.reset();
        one.device_bytes = renderer.memory().device_bytes();
        profile.actions.push_back(std::move(one));
    }
    const std::string unpainted = bench.finish_stroke();
    if (!unpainted.empty()) fail(script, ": the last stroke was not painted: ", unpainted);
    bench.perform(ui::EndStep{});
    bench.flush();
    const std::vector<std::string> messages = renderer.device().take_validation_messages();
    if (!messages.empty()) fail(messages.size(), " validation messages, the first: ", messages.front());
    profile.bytes = bytes_of(renderer);
    profile.device_budget = renderer.memory().device_budget();
    profile.host_budget = renderer.host_budget();
    return profile;
}

}  // namespace shvr::cli
