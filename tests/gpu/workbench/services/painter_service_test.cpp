// The painter alone: the order of a stroke among other steps, and what its end reports.

#include <doctest/doctest.h>

#include "engine/workbench/services/painter.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct PainterAlone : DeskWithScan {
    bool has_settings = false;
    Painter painter{desk,
                    keeper,
                    {.has_settings_to_record = [this] { return has_settings; },
                     .record_settings = notes("record_settings"),
                     .note_edit = notes("note_edit"),
                     .note_stroke = [this](bool is_empty) { calls.emplace_back(is_empty ? "empty" : "painted"); },
                     .stop_drag =
                         [this] {
                             calls.emplace_back("stop_drag");
                             document().drags_node = false;
                         },
                     .add_node_here = notes("add_node_here")}};
    int64_t painted()
    {
        const Size3 size = document().volume().size;
        return size.x * size.y * size.z - painter.model().voxels_by_group[0];
    }
};

}  // namespace

TEST_CASE_FIXTURE(PainterAlone, "painter: settings and a dragged node are recorded before the stroke, once")
{
    document().drags_node = true;
    painter.act(Paint{true});
    CHECK(take_calls() == "stop_drag record_settings");
    CHECK(painter.model().stroke_is_open);
    painter.act(Paint{true});  // a key that repeats
    CHECK(take_calls().empty());
    CHECK(contains(error_of([&] { painter.act(document().stroke()); }), "a stroke is being painted"));
    painter.act(Paint{false});
    CHECK_FALSE(painter.model().stroke_is_open);
    CHECK(painter.finish_stroke().empty());
    CHECK(take_calls() == "painted");
    CHECK(painted() > 0);
    CHECK(document().painted_at == document().touch.probe());
}

TEST_CASE_FIXTURE(PainterAlone, "painter: a stroke that changes nothing is reported as empty")
{
    painter.act(document().dab());
    CHECK(take_calls() == "record_settings painted");
    const int64_t before = painted();
    painter.act(document().dab());
    CHECK(take_calls() == "record_settings empty");
    CHECK(painted() == before);
}

TEST_CASE_FIXTURE(PainterAlone, "painter: the trace tool adds a node, and no stroke begins")
{
    document().session.probe.tool = Tool::trace;
    painter.act(Paint{true});
    painter.act(Paint{false});
    CHECK(take_calls() == "add_node_here");
    CHECK_FALSE(painter.model().is_painting);
}

TEST_CASE_FIXTURE(PainterAlone, "painter: an open stroke follows the probe, and is stuck only after the limit")
{
    painter.act(document().dab());
    const int64_t at_one_place = painted();
    painter.act(Paint{true});
    document().touch.place({24.0, 18.0, 16.0});
    painter.extend_stroke();
    painter.note_progress();
    CHECK_FALSE(painter.is_stuck());
    later_s += 3600.0;
    CHECK(painter.is_stuck());
    painter.note_progress();
    CHECK_FALSE(painter.is_stuck());
    CHECK(painter.finish_stroke().empty());
    CHECK(painted() > at_one_place);
}

TEST_CASE_FIXTURE(PainterAlone, "painter: the wait for an ended stroke is short where its bricks come over a network")
{
    desk.options.now_s = [this] { return later_s += 0.06; };
    const auto begin_long_stroke = [this] {
        Annotator& annotator = document().annotator;
        annotator.begin_stroke(document().stroke());
        for (int i = 0; i < 400; ++i) annotator.extend_stroke({10.0 + 20.0 * (i % 2), 18.0, 16.0});
        annotator.end_stroke();
    };
    document().session.volume_path = "https://example.org/scan.zarr";
    begin_long_stroke();
    const double before_s = later_s;
    painter.await_strokes();
    CHECK(painter.model().is_painting);
    CHECK(later_s - before_s < 0.5);
    document().annotator.drop_strokes();

    document().session.volume_path.clear();
    begin_long_stroke();
    const double then_s = later_s;
    painter.await_strokes();
    CHECK((!painter.model().is_painting || later_s - then_s >= 2.0));
    document().annotator.drop_strokes();
}
