#include "tests/support/workbench_state.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <set>
#include <thread>

#include <doctest/doctest.h>

#include "engine/annotation/work/journal_record.h"
#include "engine/base/file.h"
#include "engine/session/session_keys.h"
#include "engine/session/session_patch.h"
#include "engine/volume/content_hash.h"
#include "tests/support/nap.h"

namespace shvr::test {

namespace {

std::string bits_of(const glm::dvec3& point)
{
    return sentence(std::hexfloat, point.x, ' ', point.y, ' ', point.z);
}

std::string bits_of(const Camera& camera)
{
    return sentence(bits_of(camera.eye), ';', bits_of(camera.target), ';', bits_of(camera.up), ';', std::hexfloat,
                    camera.near_distance, ' ', camera.far_distance);
}

/// Names and contents of all files below a folder.
std::string content_of(const std::filesystem::path& folder)
{
    std::set<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.insert(entry.path());
    std::string text;
    for (const std::filesystem::path& file : files)
        text += sentence(file.lexically_relative(folder).string(), ':', read_text(file, int64_t{1} << 30), ';');
    return text;
}

std::string text_of(const TraceSelection& selection)
{
    std::string text;
    for (const uint32_t node : selection.nodes) text += sentence('n', node, ' ');
    for (const uint32_t internode : selection.internodes) text += sentence('i', internode, ' ');
    return text;
}

}  // namespace

std::string lasting_state(const ui::Workbench& bench)
{
    // The selection is no step of the history, and node numbers are never reused.
    Document document = bench.document().annotator.document();
    document.trace.select({});
    const std::vector<std::byte> bytes = bytes_of(document);
    size_t begin = 0;
    for (int numbers = 0; numbers < 2; ++begin) numbers += (uint8_t(bytes[begin]) & 128) == 0;  // 7 bits a byte
    return {reinterpret_cast<const char*>(bytes.data()) + begin, bytes.size() - begin};
}

State state_of(const ui::Workbench& bench, const std::filesystem::path& folder)
{
    State state;
    const ui::Model model = bench.model();
    state["open"] = sentence(model.is_open, ' ', model.session_path.string());
    state["help"] = sentence(model.shows_help);
    state["messages"] = sentence(model.shows_messages);
    state["passes"] = sentence(model.shows_passes, ' ', model.compared_passes != nullptr);
    for (const TransferPreset& preset : model.presets) state["presets"] += preset.is_own ? preset.name + ";" : "";
    for (const NamedLook& look : model.looks) state["looks"] += look.name + ";";
    state["palette"] = sentence(model.shows_palette);
    state["preferences"] = sentence(model.shows_preferences);
    state["awaits_key"] = sentence(model.awaits_key);
    state["asks"] = sentence(model.asks_what_to_open);
    state["dialog"] = spelled(model.dialog);
    state["load_preview"] = model.load_preview ? model.load_preview->path.string() : "";
    state["unclear_file"] = model.unclear_file ? model.unclear_file->path.string() : "";
    state["candidate"] = model.candidate ? model.candidate->path.string() : "";
    state["recovered"] = sentence(model.recovered.size());
    state["full_screen"] = sentence(model.is_full_screen);
    state["keys"] = sentence(spelled(model.preferences.key_set), ' ', model.preferences.keys.size());
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().extension() != ".journal" && entry.path().extension() != ".lock")
            state["file " + entry.path().filename().string()] = read_text(entry.path(), int64_t{1} << 30);
        else if (entry.is_directory() && entry.path().extension() == ".zarr")
            state["file " + entry.path().filename().string()] = content_of(entry.path());
    if (!model.is_open) return state;
    state["hand"] =
        sentence(model.hand->is_let_go, ' ', model.hand->is_grabbing, ' ', model.hand->recorded_s.has_value());
    Session session = model.session;
    for (const char* section : {"transfer_function", "groups", "unpainted", "light", "blend", "cut", "render", "view",
                                "interaction", "probe"}) {
        const JsonDocument whole(patch_between({}, session).empty() ? "{}" : patch_between({}, session), "state");
        const JsonNode part = whole.root()[section];
        state[section] = part.exists() ? part.dump() : "";
    }
    for (const auto& [name, camera] : session.cameras) state["cameras"] += name + " ";
    state["camera"] = bits_of(model.camera);
    state["place"] = bits_of(model.probe_voxel);
    for (size_t group = 1; group < model.voxels_by_group.size(); ++group)
        if (model.voxels_by_group[group] > 0)
            state["voxels"] += sentence(group, ':', model.voxels_by_group[group], ' ');
    state["trace"] = sentence(model.trace.nodes().size(), " nodes, ", model.trace.internodes().size(), " internodes");
    for (const auto& [number, node] : model.trace.nodes())
        state["trace"] +=
            sentence("; ", number, ' ', bits_of(node.position), ' ', std::hexfloat, node.radius, ' ', int(node.group));
    for (const auto& [group, radius] : model.trace.internode_radii())
        state["trace"] += sentence("; r", int(group), ' ', radius);
    state["selection"] = text_of(model.trace.selection());
    state["offsets"] = sentence(bench.document().annotator.document().density.voxels());
    state["measured"] = sentence(model.measurements.size(), model.measuring.size());
    state["drags"] = sentence(model.drags_node);
    state["painting"] = sentence(model.is_painting);
    state["undo"] = sentence(model.undoable);
    state["redo"] = sentence(model.redoable);
    state["saved"] = sentence(model.is_saved);
    return state;
}

std::string difference(const State& before, const State& after)
{
    std::set<std::string> keys;
    for (const auto& [key, value] : before)
        if (const auto found = after.find(key); found == after.end() || found->second != value) keys.insert(key);
    for (const auto& [key, value] : after)
        if (!before.contains(key)) keys.insert(key);
    std::string text;
    for (const std::string& key : keys) text += (text.empty() ? "" : ", ") + key;
    return text;
}

std::filesystem::path write_tubes_session(const std::filesystem::path& folder)
{
    const std::filesystem::path path = folder / "scan.json";
    std::ofstream(path) << R"({"shvr_session": 1, "volume": {"procedural": "tubes", "size": [40, 36, 32], "seed": 5},
        "render": {"size": [48, 40]}, "probe": {"brush": "fill", "radius_voxels": 5, "voxel": [20, 18, 16]},
        "annotation": {"mask": "scan.mask"}})";
    return path;
}

void settle(ui::Workbench& bench)
{
    constexpr int TURNS_OF_OPEN_STROKE = 100;  // which is work as long as it is open
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    for (int turn = 0; bench.has_work() || turn < 3; ++turn) {
        if (turn % 1024 == 1023 && std::chrono::steady_clock::now() > end) FAIL("the work does not end");
        nap(turn);
        if (turn > TURNS_OF_OPEN_STROKE && bench.is_open() && bench.document().annotator.stroke_is_open()) return;
        bench.advance();
    }
}

}  // namespace shvr::test
