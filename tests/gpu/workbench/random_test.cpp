// Random actions in random order: undo leads back to the start and redo to the end, bit for bit; the log
// replays to the same bits; and an action that cannot be applied now changes nothing.

#include <random>

#include <doctest/doctest.h>

#include "engine/session/session_patch.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

class Hand {
public:
    explicit Hand(uint32_t seed) : random_(seed) {}

    /// Paints, traces, sets, looks, undoes and saves, about as often as a user who explores the program.
    Action next()
    {
        switch (whole(0, 29)) {
            case 0: return Orbit{real(-40, 40), real(-20, 20)};
            case 1: return Zoom{0, {real(0, 48), real(0, 40)}, real(0.8, 1.3)};
            case 2: return LookFrom{std::vector<std::string>{"front", "top", "left", "nowhere"}[size_t(whole(0, 3))]};
            case 3:
                if (whole(0, 3) == 0) return CutObliquely{PlaneChange(whole(0, 2))};
                return MoveCut{int(whole(0, 2)), whole(0, 1) == 1, real(-0.1, 0.1)};
            case 4: return whole(0, 3) == 0 ? Action(ResetCuts{}) : Action(MoveClip{false, real(-0.1, 0.1)});
            case 5: return set("light.ambient", digits(real(0, 1)));
            case 6: return set("groups." + sentence(whole(1, 6)) + ".opacity", digits(real(0, 1)));
            case 7: return set("blend.size", digits(real(0, 1)));
            case 8:
                return set("probe.brush", std::vector<std::string>{"fill", "flood", "speckle"}[size_t(whole(0, 2))]);
            case 9: return set("probe.tool", std::string(TOOLS[size_t(whole(0, int(std::size(TOOLS)) - 1))].name));
            case 10: return set("probe.group", sentence(whole(0, 6)));
            case 11: return set("probe.preview", whole(0, 1) == 0 ? "true" : "false");
            case 12: return ScaleProbe{real(0.7, 1.4)};
            case 13: return PlaceProbe{voxel()};
            case 14: return ProbeTo{0, {real(0, 48), real(0, 40)}};
            case 15: return Paint{whole(0, 1) == 1};
            case 16: return stroke();
            case 17: return NodeOp{voxel(), real(0.5, 4), uint8_t(whole(0, 6))};
            case 18: return trace_edit();
            case 19: return SelectOp{.near = voxel(), .number = {}, .within_voxels = {}};
            case 20: return DragNode{whole(0, 1) == 1};
            case 21: return UndoOp{int(whole(1, 4))};
            case 22: return RedoOp{int(whole(1, 3))};
            case 23: return whole(0, 9) == 0 ? Action(SaveOp{}) : Action(DeselectOp{});
            case 24: return ProbeAlong{0, {real(0, 48), real(0, 40)}, whole(0, 4) == 0};
            case 25: return NodeAt{0, {real(0, 48), real(0, 40)}};
            case 26: return SelectAt{0, {real(0, 48), real(0, 40)}, whole(0, 1) == 0};
            case 27: return whole(0, 1) == 0 ? Action(MendCut{}) : Action(StepNode{whole(0, 1) == 0});
            case 28: return whole(0, 3) == 0 ? Action(ClearMeasurements{}) : Action(MeasureAt{0, {real(0, 48), 20.0}});
            default: return KeepCamera{sentence("view ", whole(1, 3))};
        }
    }

private:
    static std::string digits(double value) { return sentence(std::round(1000.0 * value) / 1000.0); }
    static Action set(const std::string& key, const std::string& value) { return Set{patch_of(key + "=" + value)}; }
    int64_t whole(int64_t lower, int64_t upper)
    {
        return std::uniform_int_distribution<int64_t>(lower, upper)(random_);
    }
    double real(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(random_); }
    glm::dvec3 voxel() { return {real(-1, 41), real(-1, 37), real(-1, 33)}; }
    Action stroke()
    {
        PaintOp op{.brush = BRUSHES[size_t(whole(0, 2))].brush,
                   .region = whole(0, 1) == 0 ? RegionShape::ball : RegionShape::box,
                   .group = uint8_t(whole(0, 6)),
                   .threshold = real(20, 200),
                   .radius_voxels = real(0.5, 7),
                   .connectivity = whole(0, 1) == 0 ? 6 : 26};
        for (int64_t i = whole(1, 3); i > 0; --i) op.path.push_back(voxel());
        if (whole(0, 3) == 0) op.density = DensityBrush{.offset = real(1, 60), .falloff = Falloff::distance};
        return op;
    }
    Action trace_edit()
    {
        switch (whole(0, 6)) {
            case 0: return DeleteOp{};
            case 1: return GroupOp{uint8_t(whole(0, 6))};
            case 2: return RadiusOp{.radius_voxels = real(0.5, 5)};
            case 3: return MoveOp{voxel()};
            case 4: return SelectSegmentOp{};
            case 5: return NodeOp{voxel(), {}, {}, uint32_t(whole(0, 30))};
            default: return LinkOp{.near = voxel(), .node = {}, .within_voxels = {}};
        }
    }
    std::mt19937 random_;
};

/// Advances until all requested work is done, except the picture. An open stroke stays open.
void finish_work(Workbench& bench)
{
    constexpr int TURNS = 3;
    const Annotator& annotator = bench.document().annotator;
    for (int turn = 0; turn < TURNS || (annotator.stroke_is_running() && !annotator.stroke_is_open()); ++turn) {
        nap(turn);
        bench.advance();
    }
    bench.advance();  // records what was set while a stroke went on
}

struct Run {
    TemporaryFolder folder;
    Workbench bench;
    int actions = 0;

    explicit Run(Renderer& renderer) : bench(renderer, {.has_servo = false})
    {
        bench.set_pixels({48, 40});
        bench.open(write_tubes_session(folder.path), {});
        settle(bench);
    }
    /// Applies an action; one that cannot be applied must change nothing. Most come while the picture is still drawn.
    void apply(const Action& action)
    {
        constexpr int ACTIONS_A_PICTURE = 8;
        // An open stroke goes on whatever else is asked for.
        const std::string why = bench.document().annotator.stroke_is_open() ? "" : bench.why_not(action);
        const std::string before = why.empty() ? std::string() : lasting_state(bench);
        static_cast<void>(bench.apply(action));
        if (++actions % ACTIONS_A_PICTURE == 0)
            settle(bench);
        else
            finish_work(bench);
        if (!why.empty()) CHECK_MESSAGE((lasting_state(bench) == before), line_of(action), ": ", why);
    }
    /// Ends held actions (painting, dragging), so that their step can be undone.
    void let_go()
    {
        apply(Paint{false});
        apply(DragNode{false});
    }
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "random actions are undone and redone bit for bit, and their log replays to the same bits")
{
    const int actions = repeats(700, 2000);
    for (uint32_t seed = 1; seed <= uint32_t(repeats(1, 3)); ++seed) {
        CAPTURE(seed);
        std::vector<std::string> log;
        std::string end;
        {
            Run run(renderer());
            const std::string start = lasting_state(run.bench);
            run.bench.log_to([&](const std::string& line) { log.push_back(line); });
            Hand hand(seed);
            for (int i = 0; i < actions; ++i) run.apply(hand.next());
            run.let_go();
            settle(run.bench);
            end = lasting_state(run.bench);
            run.bench.log_to({});
            const size_t steps = run.bench.model().undoable;
            CHECK(steps > size_t(actions / 10));
            // The first takes back no step where the last stroke changed nothing.
            while (run.bench.model().undoable > 0) REQUIRE(run.bench.apply(UndoOp{1}));
            CHECK((lasting_state(run.bench) == start));
            for (size_t i = 0; i < steps; ++i) REQUIRE(run.bench.apply(RedoOp{1}));
            CHECK((lasting_state(run.bench) == end));
        }
        Run again(renderer());
        size_t done = 0;
        for (const std::string& line : log) {
            CAPTURE(line);
            ++done;
            CAPTURE(done);
            REQUIRE_NOTHROW(again.bench.perform(read_action(line, "log")));
            finish_work(again.bench);
        }
        settle(again.bench);
        CHECK((lasting_state(again.bench) == end));
    }
}
