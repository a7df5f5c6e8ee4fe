#include "tools/cli/profile/profile_session.h"

#include <chrono>
#include <numeric>

#include "engine/annotation/script/script.h"
#include "engine/workbench/workbench.h"
#include "tools/cli/profile/temporary_folder.h"
#include "tools/cli/rest.h"

namespace shvr::cli {

namespace {

/// Values of counters at one time. An action's share is the difference between the values after and before it.
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

/// Runs frames until no work is left, and records when each stage was reached. `poll` may throw. An error message ends
/// the loop, since the workbench would retry forever.
void settle(ui::Workbench& bench, ProfiledAction& action, const std::function<double()>& now_ms,
            const std::function<void()>& poll)
{
    const auto& annotator = bench.document().annotator;
    const uint64_t told_before = bench.messages().count();
    for (uint64_t turn = 0;; ++turn) {
        const double since = now_ms() - action.begin_ms;
        if (!action.paint_ms && !annotator.stroke_is_running()) action.paint_ms = since;
        if (action.paint_ms && !action.sketch_ms && shows_at_least_a_sketch(bench)) action.sketch_ms = since;
        if (action.paint_ms && !action.sharp_ms && !bench.is_stirring() && bench.screen().complete())
            action.sharp_ms = since;
        if (!bench.has_work() || annotator.stroke_is_open()) return;
        poll();
        rest(turn);
        bench.advance();
        if (const ui::Message* error = bench.messages().first_after(told_before, ui::Weight::error)) fail(error->text);
    }
}

using Lines = std::vector<std::pair<int, ui::Action>>;

Renderer::Options renderer_options(const Common& common)
{
    const char* const validation = std::getenv("SHVR_VALIDATION");
    return {.device = {common.device, validation && *validation == '1'},
            .budget = {common.budget_device_mib << 20, common.budget_host_mib << 20},
            .threads = common.threads};
}

/// A device, and a workbench with the input opened, for one replay.
class Stage {
public:
    Stage(const std::filesystem::path& input, const Common& common)
        : renderer(renderer_options(common)), bench(renderer, {.has_servo = false, .saves_outside = common.outside})
    {
        bench.open(input, common.settings);
        if (bench.document().only_looks())
            fail(input.string(), ": cannot be changed: ", bench.document().why_only_looks(),
                 bench.document().outside.empty() ? "; expected it to be closed there first"
                                                  : "; --outside writes there");
    }
    /// Draws until the picture is complete, so that this work is not attributed to the first action.
    void set_up(const std::function<void()>& poll)
    {
        bench.set_pixels(bench.document().session.render.size);
        bench.set_hand_down(true);  // setting changes stay in one history step until the script ends it
        ProfiledAction opening;
        bench.advance();
        settle(
            bench, opening, [] { return 0.0; }, poll);
    }
    /// Writes all actions to the journal. Fails if a stroke was not painted or the validation layer reported errors.
    void finish(const std::string& script)
    {
        const std::string unpainted = bench.finish_stroke();
        if (!unpainted.empty()) fail(script, ": the last stroke was not painted: ", unpainted);
        bench.perform(ui::EndStep{});
        bench.flush();
        const std::vector<std::string> messages = renderer.device().take_validation_messages();
        if (!messages.empty()) fail(messages.size(), " validation messages, the first: ", messages.front());
    }

    Renderer renderer;
    ui::Workbench bench;
};

ProfiledAction profiled(Stage& stage, int line, const ui::Action& action, const std::function<double()>& now_ms,
                        const std::function<void()>& poll)
{
    ui::Workbench& bench = stage.bench;
    ProfiledAction one{.line = line, .action = Json::parse(ui::line_of(action)).at("op").get<std::string>()};
    const SessionCounts before(bench, stage.renderer);
    one.begin_ms = now_ms();
    bench.perform(action);
    if (bench.has_work() && !bench.document().annotator.stroke_is_open()) bench.advance();
    settle(bench, one, now_ms, poll);
    one.end_ms = now_ms();
    const SessionCounts after(bench, stage.renderer);
    one.submits = after.submits - before.submits;
    one.allocations = after.allocations - before.allocations;
    one.uploads = after.uploads - before.uploads;
    one.evictions = after.evictions - before.evictions;
    one.voxels_painted = after.painted - before.painted;
    if (one.voxels_painted == 0) one.paint_ms.reset();
    one.device_bytes = stage.renderer.memory().device_bytes();
    return one;
}

/// Replays the script. `tell` receives the completed fraction; it and `poll` may throw. `of_copy`: the input is a copy,
/// without its earlier history.
Replayed replay(Stage& stage, const std::string& script, const Lines& lines, bool of_copy,
                const std::function<void(double)>& tell, const std::function<void()>& poll)
{
    stage.set_up(poll);
    const auto started = std::chrono::steady_clock::now();
    const auto now_ms = [&] {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
    };
    const uint64_t openings = stage.bench.openings();
    Replayed done;
    for (const auto& [line, action] : lines) {
        tell(double(done.size()) / double(lines.size()));
        try {
            done.push_back(profiled(stage, line, action, now_ms, poll));
        } catch (const DeviceLost&) {
            throw;
        } catch (const Stopped&) {
            throw;
        } catch (const Error& error) {
            fail(script, ":", line, ": ", error.what(),
                 of_copy ? " (in a replay on a copy of the work, which begins without its history)" : "");
        }
        if (stage.bench.openings() != openings)
            fail(script, ":", line, ": opens another volume; expected actions on the input alone");
    }
    stage.finish(script);
    return done;
}

/// Copies the input's files in their present state, once for each replay.
std::vector<std::filesystem::path> copies_of(const std::string& input, const Common& common,
                                             const std::filesystem::path& folder, int count)
{
    const Stage stage(input, common);
    std::vector<std::filesystem::path> copies;
    for (int number = 1; number <= count; ++number) {
        const std::filesystem::path place = folder / sentence("replay-", number);
        std::filesystem::create_directory(place);
        copies.push_back(stage.bench.document().copier(place / "session.json")());
    }
    return copies;
}

}  // namespace

SessionProfile profile_session(const std::string& input, const std::string& script, int replays, const Common& common)
{
    Lines lines;
    for_each_line(script, [&](const JsonNode& line, int number) { lines.emplace_back(number, ui::read_action(line)); });
    if (lines.empty()) fail(script, ": holds no action; expected one JSON object a line, as shvr view --log writes");
    LongWork work(common.quiet);
    SessionProfile profile{.input = input, .script = script};
    const auto replayed = [&](Stage& stage, bool of_copy) {
        static_cast<void>(work.begin("replaying " + script));
        const auto tell = [&](double share) {
            work.show((double(profile.replays.size()) + share) / double(replays), {}, -1.0);
            work.stop_if_asked();
        };
        profile.replays.push_back(replay(stage, script, lines, of_copy, tell, [&] { work.stop_if_asked(); }));
    };
    static_cast<void>(work.begin("opening " + input));
    // The copies are replayed first: if the script fails on a copy, the input itself is still unchanged.
    const TemporaryFolder folder("shvr-replays");
    if (replays > 1)
        for (const std::filesystem::path& copy : copies_of(input, common, folder.path, replays - 1)) {
            Stage stage(copy, common);
            replayed(stage, true);
        }
    Stage stage(input, common);
    replayed(stage, false);
    const gpu::DeviceTraits& traits = stage.renderer.device().traits();
    profile.device = traits.name;
    profile.driver = traits.driver;
    profile.size = stage.bench.document().session.render.size;
    profile.bytes = bytes_of(stage.renderer);
    profile.device_budget = stage.renderer.memory().device_budget();
    profile.host_budget = stage.renderer.host_budget();
    return profile;
}

}  // namespace shvr::cli
