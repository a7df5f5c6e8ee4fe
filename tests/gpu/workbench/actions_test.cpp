// Every action, applied once without a display: its changes, and that nothing else changes. The table is the
// documentation of the actions; engine/workbench/ACTIONS.md is printed from it.

#include <set>

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct Row {
    const char* line;                   ///< the action as a script line
    const char* changes;                ///< keys of the state, in order
    std::vector<const char*> before{};  ///< actions that prepare it
    bool is_saved_before = true;
};

constexpr const char* STROKE =
    R"({"op":"paint","brush":"fill","region":"ball","group":3,"threshold":100,"radius":6,"path":[[20,18,16],[24,18,16]]})";
constexpr const char *NODE = R"({"op":"node","at":[10,12,14],"radius":2,"group":2})",
                     *NEXT_NODE = R"({"op":"node","at":[20,12,14]})", *LAST_NODE = R"({"op":"node","at":[20,22,14]})",
                     *TRACING = R"({"op":"set","values":{"probe":{"tool":"trace"}}})",
                     *ERASING = R"({"op":"set","values":{"probe":{"tool":"erase"}}})",
                     *OVERVIEW = R"({"op":"set","values":{"view":{"arrangement":"overview"}}})",
                     *BY_HAND = R"({"op":"set","values":{"light":{"occlusion":{"strength":0.5,"automatic":false}}}})",
                     *NEAR_3 = R"({"op":"keep_camera","name":"node 3"})",
                     *LOOK_NEAR_3 = R"({"op":"keep_camera","name":"node 3","with_look":true})",
                     *KEEP = R"({"op":"keep_preset","name":"vessels"})",
                     *KEEP_LOOK = R"({"op":"keep_look","name":"mine"})",
                     *HOT = R"({"op":"take_preset","path":"FOLDER/hot.json"})",
                     *BRIGHT = R"({"op":"set","values":{"light":{"ambient":0.9}}})",
                     *COMPARE = R"({"op":"compare_passes","path":"FOLDER/run.json"})",
                     *OBLIQUE = R"({"op":"oblique_cut","change":"add"})",
                     *CUT = R"({"op":"move_cut","axis":0,"share":0.25})", *BEGIN = R"({"op":"paint_here","on":true})",
                     *DRAG = R"({"op":"drag_node","on":true})", *UNDO = R"({"op":"undo"})", *SAVE = R"({"op":"save"})",
                     *TO_NODE = R"({"op":"step_node"})", *DESELECT = R"({"op":"deselect"})",
                     *SELECT_1 = R"({"op":"select","node":1})", *SEGMENT = R"({"op":"select_segment"})",
                     *MEASURE = R"({"op":"measure_at","pixel":[48,40]})",
                     *MEASURE_ON = R"({"op":"measure_at","pixel":[60,40]})",
                     *MEASURE_PATHS = R"({"op":"set","values":{"probe":{"measure":"path"}}})",
                     *DARK = R"({"op":"set","values":{"view":{"slices":{"white":900}}}})",
                     *STROKE_5 =
                         R"({"op":"paint","brush":"fill","group":5,"threshold":90,"radius":4,"path":[[9,18,16]]})";

constexpr const char
    *HOLLOW_BALL = R"({"op":"paint","brush":"fill","group":3,"threshold":-9,"radius":4,"path":[[20.5,18.5,16.5]]})",
    *HOLE = R"({"op":"paint","brush":"fill","group":0,"threshold":-9,"radius":1,"path":[[20.5,18.5,16.5]]})",
    *BALL = R"({"op":"paint","brush":"fill","group":3,"threshold":-9,"radius":2,"path":[[14.5,18.5,16.5]]})",
    *NEXT_BALL = R"({"op":"paint","brush":"fill","group":3,"threshold":-9,"radius":2,"path":[[24.5,18.5,16.5]]})";
constexpr const char *SLICES = R"({"op":"set","values":{"view":{"arrangement":"slices"}}})",
                     *CLOSER = R"({"op":"zoom","pane":1,"pixel":[10,12],"factor":3})";

const Row ROWS[] = {
    {R"({"op":"orbit","right_degrees":30,"up_degrees":-10})", "camera"},
    {R"({"op":"roll","degrees":15})", "camera"},
    {R"({"op":"move_view","heights":[0.1,0,0.2]})", "camera"},
    {R"({"op":"zoom","pixel":[10,12],"factor":1.5})", "camera"},
    {R"({"op":"zoom","pane":1,"pixel":[10,12],"factor":3})", "view", {SLICES}},
    {R"({"op":"drag_in_map","pane":1,"pixels":[4,3]})", "camera", {OVERVIEW}},
    {R"({"op":"drag_in_map","pane":1,"pixels":[4,3]})", "view", {SLICES}},
    {R"({"op":"look_from","camera":"top"})", "camera"},
    {R"({"op":"look_from","camera":"node 3","with_look":true})",
     "camera, light, saved, undo",
     {LOOK_NEAR_3, BRIGHT, R"({"op":"orbit","right_degrees":30})"}},
    {R"({"op":"keep_camera","name":"node 3"})", "cameras, saved"},
    {R"({"op":"keep_camera","name":"node 3","with_look":true})", "cameras, saved"},
    {R"({"op":"forget_camera","name":"node 3"})", "cameras, saved", {NEAR_3}},
    {R"({"op":"rename_camera","name":"node 3","to":"leaf"})", "cameras, saved", {NEAR_3}},
    {R"({"op":"pivot_at","pixel":[48,40]})", "interaction, saved"},
    {R"({"op":"go_to","voxel":[3,4,5]})", "camera"},
    {R"({"op":"move_cut","axis":1,"upper":true,"share":-0.25})", "cut, saved, undo"},
    {R"({"op":"move_clip","share":0.5})", "camera"},
    {R"({"op":"place_clips","near":12,"far":80})", "camera"},
    {R"({"op":"oblique_cut","change":"add"})", "cut, saved, undo"},
    {R"({"op":"oblique_cut","change":"flip"})", "cut, saved, undo", {OBLIQUE}},
    {R"({"op":"oblique_cut","change":"remove"})", "cut, saved, undo", {OBLIQUE}},
    {R"({"op":"reset_cuts"})", "camera, cut, saved, undo", {CUT, R"({"op":"move_clip","share":0.5})"}},
    {R"({"op":"fit_view"})", "camera"},
    {R"({"op":"fit_view","pane":1})", "view", {SLICES, CLOSER}},
    {R"({"op":"reset_view"})", "camera", {R"({"op":"orbit","right_degrees":30})"}},
    {R"({"op":"look_at_selection"})", "camera", {NODE, NEXT_NODE}},
    {R"({"op":"update_occlusion"})", "", {BY_HAND}},
    {R"({"op":"set","values":{"light":{"ambient":0.45}}})", "light, saved, undo"},
    {R"({"op":"set","values":{"groups":{"3":{"name":"leaf trace","color":"#20b060"}}}})", "groups, saved, undo"},
    {R"({"op":"set","values":{"unpainted":{"opacity":0.25}}})", "saved, undo, unpainted"},
    {R"({"op":"set","values":{"groups":{"3":{"parent":2}}}})", "groups, saved, undo"},
    {R"({"op":"set","values":{"view":{"solo":3}}})", "saved, view"},
    {R"({"op":"set","values":{"render":{"quality":"draft"}}})", "render, saved"},
    {R"({"op":"set","values":{"blend":{"size":0.4}}})", "blend, saved, undo"},
    {R"({"op":"set","values":{"transfer_function":{"points":[{"intensity":90,"opacity":0},{"intensity":200,"opacity":1}]}}})",
     "saved, transfer_function, undo"},
    {R"({"op":"set","values":{"probe":{"group":7,"preview":true}}})", "probe, saved"},
    {R"({"op":"set","values":{"probe":{"paint_threshold":null}}})",
     "probe, saved",
     {R"({"op":"set","values":{"probe":{"paint_threshold":77}}})"}},
    {R"({"op":"set","values":{"view":{"arrangement":"slices"}}})", "saved, view"},
    {R"({"op":"set","values":{"render":{"step_voxels":0.7}}})", "render, saved"},
    {R"({"op":"set","values":{"interaction":{"resolution":0.5}}})", "interaction, saved"},
    {R"({"op":"new_group"})", "groups, saved, undo"},
    {R"({"op":"end_step"})", ""},
    {R"({"op":"auto_contrast"})", "saved, view", {DARK}},
    {R"({"op":"keep_preset","name":"vessels"})", "presets"},
    {R"({"op":"rename_preset","name":"vessels","to":"bundles of mine"})", "presets", {KEEP}},
    {R"({"op":"forget_preset","name":"vessels"})", "presets", {KEEP}},
    {R"({"op":"take_preset","path":"FOLDER/hot.json"})", "saved, transfer_function, undo"},
    {R"({"op":"keep_look","name":"mine"})", "looks"},
    {R"({"op":"keep_look","path":"FOLDER/mine.json"})", "file mine.json"},
    {R"({"op":"take_look","name":"mine"})", "light, saved, transfer_function, undo", {KEEP_LOOK, HOT, BRIGHT}},
    {R"({"op":"forget_look","name":"mine"})", "looks", {KEEP_LOOK}},
    {R"({"op":"probe_to","pixel":[20,20]})", "place"},
    {R"({"op":"probe_onto","pixel":[48,40]})", "place"},
    {R"({"op":"probe_along","pixel":[48,40]})", "place"},
    {R"({"op":"push_probe","voxels":2})", "place"},
    {R"({"op":"place_probe","voxel":[11,12,13]})", "place"},
    {R"({"op":"scale_probe","factor":1.5})", "probe, saved"},
    {R"({"op":"paint_here","on":true})", "painting, saved, undo, voxels"},
    {R"({"op":"paint_here","on":false})", "painting", {BEGIN}},
    {R"({"op":"paint_here","on":true})",
     "painting, saved, undo, voxels",
     {STROKE, R"({"op":"place_probe","voxel":[20,18,16]})", ERASING}},
    {R"({"op":"paint_here","on":true})", "saved, selection, trace, undo", {TRACING}},
    {STROKE, "saved, undo, voxels"},
    {R"({"op":"density","brush":"fill","region":"ball","threshold":60,"radius":4,"offset":30,"path":[[20,18,16]]})",
     "offsets, saved, undo"},
    {R"({"op":"combine","group":7,"with":3,"how":"add"})", "saved, undo, voxels", {STROKE}},
    {R"({"op":"islands","group":3,"keep":"at_least","voxels":100000})", "saved, undo, voxels", {STROKE}},
    {R"({"op":"threshold","group":3,"from":60,"to":255,"box":[0,0,0,20,20,20]})", "saved, undo, voxels"},
    {R"({"op":"fill_holes","group":3})", "saved, undo, voxels", {HOLLOW_BALL, HOLE}},
    {R"({"op":"fill_between","group":3,"axis":"x"})", "saved, undo, voxels", {BALL, NEXT_BALL}},
    {R"({"op":"grow","group":3,"distance":2.5})", "saved, undo, voxels", {HOLLOW_BALL}},
    {R"({"op":"shrink","group":3,"distance":2.5})", "saved, undo, voxels", {HOLLOW_BALL}},
    {R"({"op":"open_group","group":3,"distance":2.5})", "saved, undo, voxels", {HOLLOW_BALL}},
    {R"({"op":"close","group":3,"distance":2.5})", "saved, undo, voxels", {HOLLOW_BALL, HOLE}},
    {R"({"op":"hollow","group":3,"wall":2,"side":"in"})", "saved, undo, voxels", {HOLLOW_BALL}},
    {R"({"op":"smooth","distance":2})", "saved, undo, voxels", {HOLLOW_BALL}},
    {R"({"op":"preview_operation","operation":"{\"op\":\"grow\",\"group\":3,\"distance\":2.5}"})", "", {HOLLOW_BALL}},
    {R"({"op":"grow_seeds","on":"gradient","margin":2})", "saved, undo, voxels", {BALL, NEXT_BALL}},
    {R"({"op":"lasso","polygon":[[12,12],[20,12],[16,24]],"camera":"front"})", "saved, undo, voxels", {BALL}},
    {R"({"op":"mask_from_trace","group":3})", "saved, undo, voxels", {NODE, NEXT_NODE}},
    {R"({"op":"trace_from_mask","group":3,"spur":2})", "saved, trace, undo", {HOLLOW_BALL}},
    {R"({"op":"drag_node","on":true})", "drags", {NODE, NEXT_NODE}},
    {R"({"op":"drag_node","on":false})", "drags, saved, trace, undo", {NODE, NEXT_NODE, DRAG}},
    {R"({"op":"node","at":[10,12,14],"radius":2,"group":2})", "saved, selection, trace, undo"},
    {R"({"op":"select","node":0})", "selection", {NODE, NEXT_NODE}},
    {R"({"op":"select_segment"})", "selection", {NODE, NEXT_NODE}},
    {R"({"op":"deselect"})", "selection", {NODE, NEXT_NODE}},
    {R"({"op":"link","node":0})", "saved, trace, undo", {NODE, NEXT_NODE, LAST_NODE}},
    {R"({"op":"move","to":[22,14,15]})", "saved, trace, undo", {NODE, NEXT_NODE}},
    {R"({"op":"move","to":[24,12,15],"from":[22,12,14]})", "saved, trace, undo", {NODE, NEXT_NODE, SEGMENT}},
    {R"({"op":"delete"})", "saved, selection, trace, undo", {NODE, NEXT_NODE}},
    {R"({"op":"group","group":5})", "saved, trace, undo", {NODE, NEXT_NODE}},
    {R"({"op":"radius","radius":3.5})", "saved, trace, undo", {NODE, NEXT_NODE}},
    {R"({"op":"node_at","pixel":[48,40]})", "place, saved, selection, trace, undo"},
    {R"({"op":"select_at","pixel":[48,40]})", "selection", {NODE, NEXT_NODE, TO_NODE, DESELECT}},
    {R"({"op":"step_node"})", "camera, place, selection", {NODE, NEXT_NODE}},
    {R"({"op":"mend_cut"})", "saved, trace, undo", {NODE, NEXT_NODE, LAST_NODE, SELECT_1, R"({"op":"delete"})"}},
    {R"({"op":"measure_at","pixel":[48,40]})", "measured"},
    {R"({"op":"measure_at","pixel":[60,40]})", "measured, saved, undo", {MEASURE}},
    {R"({"op":"end_measure"})", "measured, saved, undo", {MEASURE_PATHS, MEASURE, MEASURE_ON}},
    {R"({"op":"take_back_point"})", "measured", {MEASURE}},
    {R"({"op":"rename_measurement","number":1,"to":"stem"})", "saved, undo", {MEASURE, MEASURE_ON}},
    {R"({"op":"remove_measurement","number":1})", "measured, saved, undo", {MEASURE, MEASURE_ON}},
    {R"({"op":"clear_measurements"})", "measured, saved, undo", {MEASURE, MEASURE_ON}},
    {R"({"op":"copy_measurements"})", "", {MEASURE, MEASURE_ON}},
    {R"({"op":"undo"})", "redo, saved, undo, voxels", {STROKE}},
    {R"({"op":"redo"})", "redo, saved, undo, voxels", {STROKE, UNDO}},
    {R"({"op":"save"})", "file scan.json, file scan.mask, file scan.mask.json, saved", {STROKE}, false},
    {R"({"op":"revert"})", "undo, voxels", {STROKE, SAVE, STROKE_5}, false},
    {R"({"op":"save_as","path":"FOLDER/next.json"})",
     "file next.graphml, file next.json, file next.labels.zarr, file preferences.json, open",
     {STROKE, NODE}},
    {R"({"op":"copy_session","path":"FOLDER/copy.json"})",
     "file copy.graphml, file copy.json, file copy.labels.zarr",
     {STROKE, NODE}},
    {R"({"op":"export","mask":"FOLDER/out.nrrd","trace":"FOLDER/out.swc","surface":"FOLDER/out.ply"})",
     "file out.nrrd, file out.ply, file out.swc",
     {STROKE, NODE}},
    {R"({"op":"import","volume":"FOLDER/tiny.nrrd","project":"FOLDER/made"})",
     "camera, file preferences.json, open, place, probe, render, transfer_function, view"},
    {R"({"op":"label","threshold":100,"output":"FOLDER/parts.nrrd"})", "file parts.nrrd"},
    {R"({"op":"evaluate","truth_mask":"FOLDER/scan.mask","mask":"FOLDER/scan.mask","volume":"FOLDER/scan.json"})",
     "",
     {STROKE}},
    {R"({"op":"open","path":"FOLDER/tiny.nrrd"})",
     "camera, file preferences.json, light, open, place, probe, render, transfer_function, view"},
    {R"({"op":"screenshot"})", "file scan-view-1.png"},
    {R"({"op":"screenshot","large":true})", "file scan-view-1.png"},
    {R"({"op":"figure","path":"FOLDER/figure.tif","pixels":[40,30]})", "file figure.tif"},
    {R"({"op":"movie","path":"FOLDER/frames","turntable_degrees":90,"frames":2,"pixels":[40,30]})", ""},
    {R"({"op":"work_on_copy"})",
     "cameras, file preferences.json, file scan-copy.json, file scan-copy.labels.zarr, open, undo",
     {STROKE}},
    {R"({"op":"open_example"})",
     "camera, cameras, file preferences.json, groups, light, open, place, probe, render, transfer_function, view"},
    {R"({"op":"look_at_file","path":"FOLDER/tiny.nrrd"})", "candidate"},
    {R"({"op":"take_file","path":"FOLDER/tiny.nrrd"})",
     "camera, file preferences.json, light, open, place, probe, render, transfer_function, view"},
    {R"({"op":"take_file","path":"FOLDER/look.json","beside":"FOLDER/line.txt"})",
     "saved, trace, transfer_function, undo"},
    {R"({"op":"take_file","path":"FOLDER/look.json"})", "saved, transfer_function, undo"},
    {R"({"op":"take_file","path":"FOLDER/line.txt"})", "saved, trace, undo"},
    {R"({"op":"take_file","path":"FOLDER/other.mask"})", "saved, undo, voxels"},
    {R"({"op":"take_file","path":"FOLDER/other.mask","previews":true})", "load_preview"},
    {R"({"op":"load","path":"FOLDER/other.mask"})", "saved, undo, voxels"},
    {R"({"op":"load","path":"FOLDER/line.txt","what":"trace"})", "saved, trace, undo"},
    {R"({"op":"preview_load","path":"FOLDER/other.mask"})", "load_preview"},
    {R"({"op":"dismiss_unclear_file"})", "unclear_file", {R"({"op":"take_file","path":"FOLDER/as_large.nrrd"})"}},
    {R"({"op":"forget_recent","path":"FOLDER/scan.json"})", "file preferences.json"},
    {R"({"op":"ask_open","on":true})", "asks"},
    {R"({"op":"choose_keys","set":"thesis"})", "file preferences.json, keys"},
    {R"({"op":"bind_keys","shortcut":"undo","keys":"Ctrl+U"})", "file preferences.json, keys"},
    {R"({"op":"resize","pixels":[64,48]})", ""},
    {R"({"op":"await_key","shortcut":"undo"})", "awaits_key"},
    {R"({"op":"show_help","on":true})", "help"},
    {R"({"op":"show_manual"})", ""},
    {R"({"op":"show_messages","on":true})", "messages"},
    {R"({"op":"show_passes","on":true})", "passes"},
    {R"({"op":"show_dialog","dialog":"export"})", "dialog"},
    {R"({"op":"save_passes","path":"FOLDER/saved.json"})", "file saved.json"},
    {R"({"op":"compare_passes","path":"FOLDER/run.json"})", "passes"},
    {R"({"op":"compare_passes"})", "passes", {COMPARE}},
    {R"({"op":"show_palette","on":true})", "palette"},
    {R"({"op":"prefer","values":{"theme":"light","layout":{"panels":{"groups":{"place":"floating"}}}}})",
     "file preferences.json"},
    {R"({"op":"show_preferences","on":true})", "preferences"},
    {R"({"op":"focus","what":"menu"})", ""},
    {R"({"op":"full_screen","on":true})", "full_screen"},
    {R"({"op":"quit"})", ""},
    {R"({"op":"quit","saves":false})", "redo, selection, trace, undo", {NODE}, false},
    {R"({"op":"let_go","on":true})", "hand"},
    {R"({"op":"use_device"})", ""},
    {R"({"op":"find_devices"})", ""},
    {R"({"op":"follow_stylus","path":"FOLDER/hand.trace"})", "saved, undo, voxels"},
    {R"({"op":"follow_stylus","path":"FOLDER/hand.trace","by_hand":false})",
     "place, saved, selection, trace, undo",
     {TRACING}},
};

/// A workbench on a scan of its own.
struct Bench {
    TemporaryFolder folder;
    std::unique_ptr<Workbench> bench;

    explicit Bench(Renderer& renderer)
    {
        bench = std::make_unique<Workbench>(renderer, WorkbenchOptions{.has_servo = false, .settings = folder.path});
        bench->set_pixels({96, 80});
        std::string tiny = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n";
        for (int voxel = 0; voxel < 512; ++voxel) tiny += char(voxel % 251);
        folder.write("tiny.nrrd", tiny);
        folder.write("run.json", R"({"passes":[{"name":"raycast","runs":2,"total_ms":3.5,"longest_ms":2}]})");
        folder.write(
            "hot.json",
            R"({"note":"n","points":[{"at":0,"color":"#100000","opacity":0},{"at":1,"color":"#ff2010","opacity":1}]})");
        folder.write("look.json", R"({"points":[{"intensity":70,"opacity":0},{"intensity":210,"opacity":0.8}]})");
        folder.write("line.txt", "-v 10, 12, 14, 1, 2\n-v 20, 12, 14, 1, 2\n-l 0, 1, 2\n");
        folder.write("hand.trace",
                     "{\"shvr_stylus_trace\":1,\"unit\":\"voxel\"}\n"
                     "{\"settings\":{\"to_volume\":[1000,0,0,0,1000,0,0,0,1000],\"origin\":[20,18,16]}}\n"
                     "{\"at\":[0,0,0],\"buttons\":1}\n{\"at\":[0.001,0,0]}\n");
        folder.write("as_large.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 36 32\nencoding: raw\n\n" +
                                          std::string(40 * 36 * 32, '\4'));
        folder.write("other.mask", std::string(40 * 36 * 32, '\4'));
        bench->open(write_tubes_session(folder.path), {});
        settle(*bench);
    }
    void perform(const std::string& line)
    {
        CAPTURE(line);
        const size_t steps = bench->model().undoable;
        bench->perform(action_of(line));
        settle(*bench);
        // Until the device has answered for what the open stroke covers.
        for (int turn = 0; bench->model().is_painting && bench->model().undoable == steps; ++turn) {
            nap(turn);
            bench->advance();
        }
    }
    /// FOLDER in the line stands for the scan's.
    Action action_of(std::string line) const
    {
        const std::string name = "FOLDER";
        for (size_t at = line.find(name); at != std::string::npos; at = line.find(name))
            line.replace(at, name.size(), folder.path.string());
        return read_action(line, "row");
    }
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "each action changes what it is there for, and nothing else")
{
    std::set<std::string> applied;
    for (const Row& row : ROWS) {
        const std::string row_line = row.line;
        CAPTURE(row_line);
        Bench on(renderer());
        for (const char* line : row.before) on.perform(line);
        if (row.is_saved_before && !on.bench->model().is_painting) on.perform(R"({"op":"save"})");
        const State before = state_of(*on.bench, on.folder.path);
        const Action action = on.action_of(row.line);
        CHECK(on.bench->why_not(action) == "");
        on.perform(row.line);
        on.bench->wait_for_screenshots();
        settle(*on.bench);
        CHECK(difference(before, state_of(*on.bench, on.folder.path)) == std::string(row.changes));
        CHECK(on.bench->messages().count() > 0);
        applied.insert(row_of(action).id);
    }
    // Actions that need conditions which this table does not set up, and the tests that do.
    applied.insert({"choose_belief", "cancel_job", "dismiss_notices", "correct_spacing",
                    // tests/window/first/test_view_kept.py
                    "settle_import",
                    // tests/gpu/workbench/services/saver_service_test.cpp
                    "stay_open",
                    // tests/gpu/workbench/hand_test.cpp
                    "grab_volume", "calibrate_device", "record_stylus", "stop_recording"});
    for (const ActionRow& row : action_rows()) CHECK_MESSAGE(applied.contains(row.id), row.id);
}

TEST_CASE("ACTIONS.md says of each action what the program says")
{
    std::string expected =
        "# Actions\n\nWhat a person can do, as lines of a script or a log; each with what it changes, as\n"
        "`tests/gpu/workbench/actions_test.cpp` tries it. That test prints this file where it differs.\n";
    std::string group;
    for (const ActionRow& action : action_rows()) {
        if (std::exchange(group, action.group) != action.group)
            expected +=
                sentence("\n## ", action.group, "\n\n| action | does | for example | changes |\n|---|---|---|---|\n");
        std::string examples, changes;
        for (const Row& row : ROWS) {
            if (std::string(row_of(read_action(row.line, "row")).id) != action.id) continue;
            examples += sentence(examples.empty() ? "" : "<br>", '`', row.line, '`');
            changes += sentence(changes.empty() ? "" : "<br>", row.changes);
        }
        expected += sentence("| `", action.id, "` | ", action.meaning, " | ", examples, " | ", changes, " |\n");
    }
    const std::string written = read_text("engine/workbench/ACTIONS.md", int64_t{1} << 20);
    if (written != expected) std::puts(expected.c_str());
    CHECK((written == expected));
}
