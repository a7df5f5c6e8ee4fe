#pragma once
// A desk with an open scan and no service, for tests that construct one service alone, with functions of their own in
// place of those that it calls. One thread, the renderer's.

#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/desk/preference_keeper.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"

namespace shvr::test {

struct DeskWithScan : OnDevice {
    TemporaryFolder folder;
    double later_s = 0.0;  ///< added to the clock
    ui::Desk desk{renderer(), {.has_servo = false}};
    ui::PreferenceKeeper keeper{desk};
    std::filesystem::path session_path = folder.path / "scan.json";
    std::vector<std::string> calls;    ///< calls of other services, by the names that `notes` was given
    std::vector<std::string> applied;  ///< lines of actions that the service passed to the workbench

    DeskWithScan()
    {
        desk.options.now_s = [this] {
            return later_s + std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
        };
        desk.apply = [this](const ui::Action& action) {
            applied.push_back(ui::line_of(action));
            return true;
        };
        desk.model = [this] { return model(); };
        write_session(session_path);
        OpenedSession opened = open_session(session_path);
        renderer().load(opened.source, opened.statistics, opened.session.render);
        desk.document = std::make_unique<ui::Document>(
            renderer(), ui::Document::read(std::move(opened), session_path, {}, {.program = "a test"}, false),
            View::Options{});
        desk.openings = 1;
    }

    /// A session of a procedural scan of tubes, without annotation.
    static void write_session(const std::filesystem::path& path)
    {
        std::ofstream(path)
            << R"({"shvr_session": 1, "volume": {"procedural": "tubes", "size": [40, 36, 32], "seed": 5},
            "render": {"size": [48, 40]}, "probe": {"brush": "fill", "radius_voxels": 5, "voxel": [20, 18, 16]},
            "annotation": {"mask": "scan.mask"}})";
    }
    ui::Document& document() { return *desk.document; }
    const TraceGraph& trace() { return document().annotator.document().trace; }
    const std::string& said() const { return desk.messages.last(); }
    bool says(std::string_view part) const { return contains(said(), part); }
    /// Paints at the probe, and returns the middle of a voxel that was painted.
    glm::dvec3 paint()
    {
        document().annotator.paint(document().dab());
        const Mask& mask = document().annotator.document().mask;
        const Size3 size = document().volume().size;
        for (int64_t i = 0; i < size.x * size.y * size.z; ++i) {
            const Size3 at{i % size.x, i / size.x % size.y, i / size.x / size.y};
            if (mask.at(at) != 0) return glm::dvec3(at) + 0.5;
        }
        FAIL("nothing was painted");
        return {};
    }
    /// Returns the calls so far, with blanks between, and clears them.
    std::string take_calls()
    {
        std::string text;
        for (const std::string& call : std::exchange(calls, {})) text += (text.empty() ? "" : " ") + call;
        return text;
    }
    /// A function of another service, whatever its arguments: notes that it was called.
    auto notes(const char* name)
    {
        return [this, name](const auto&...) { calls.emplace_back(name); };
    }
    /// The panes of the session in a picture of 48 x 40 pixels.
    Pane pane(size_t index)
    {
        return panes_of(document().session.view, document().camera, {48, 40}, document().volume(),
                        document().probe_voxel())
            .at(index);
    }
    /// Calls `step` until `condition` holds; fails after two minutes.
    template <class Step, class Condition>
    void until(const Step& step, const Condition& condition)
    {
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
        while (!condition()) {
            REQUIRE(std::chrono::steady_clock::now() < end);
            step();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    /// Only what the desk itself knows.
    ui::Model model() const
    {
        return {desk.document_model(),
                {.panes = desk.nothing.panes},
                {},
                {},
                {},
                {},
                {},
                {.trace = desk.nothing.trace},
                {},
                {},
                {},
                {},
                {},
                keeper.model(),
                {.presets = presets},
                {},
                {}};
    }
    const std::vector<TransferPreset> presets{};
};

}  // namespace shvr::test
