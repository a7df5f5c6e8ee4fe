// The dialog that asks for a file, and the start page, which is shown while nothing is open.

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/models/preferences.h"
#include "ui/panels/dialogs/file_chooser.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

FileChooser opening({.title = "Open a volume, a session or a project",
                     .verb = "Open",
                     .note = names_of_formats("and") +
                             "; OME-Zarr at https:// and s3://. No header: Open with options."});
FileChooser saving({.title = "Continue under another name",
                    .verb = "Save",
                    .note = "Session (.json); mask, trace and history are written next to it. Existing files stay.",
                    .wanted = FileChooser::Wanted::new_file});
FileChooser labelled({.title = "Open the scan of a label image",
                      .verb = "Open",
                      .note = "The label image is loaded into it as its mask; undo takes that back."});
FileChooser annotating(
    {.title = "Annotate a volume on another machine",
     .verb = "Annotate",
     .note = "Session (.json) that names the address; mask, trace and history are written next to it.",
     .wanted = FileChooser::Wanted::new_file});
std::filesystem::path labels_of_scan;  ///< the label image whose scan the `labelled` dialog asks for

std::vector<Place> places_of(const Model& model)
{
    return places(model.is_open ? model.session.volume_path : std::filesystem::path(), model.preferences.recent);
}

/// Returns whether a path no longer exists. The paths are checked in the background when the list changes. No caller
/// waits for the check, not even at exit: a network that does not answer takes minutes to fail.
bool is_gone(const std::filesystem::path& path, const std::vector<std::filesystem::path>& recent)
{
    struct Search {
        std::mutex mutex;
        std::vector<std::filesystem::path> gone;
    };
    static std::vector<std::filesystem::path> known;
    static auto search = std::make_shared<Search>();
    if (known != recent) {
        known = recent;
        search = std::make_shared<Search>();
        std::thread([search = search, recent] {
            for (const std::filesystem::path& each : recent) {
                std::error_code ignored;
                if (is_typed_address(each.string()) || std::filesystem::exists(each, ignored) ||
                    is_within_archive(each))
                    continue;
                const std::scoped_lock lock(search->mutex);
                search->gone.push_back(each);
            }
        }).detach();
    }
    const std::scoped_lock lock(search->mutex);
    return std::ranges::find(search->gone, path) != search->gone.end();
}

/// Lists recently opened paths: the name, its folder and, for a missing path, a cross that removes the entry.
void recent_list(const Model& model, Actions& actions)
{
    const auto& recent = model.preferences.recent;
    const float cross = ImGui::GetFrameHeight();
    for (size_t i = 0; i < recent.size(); ++i) {
        const std::filesystem::path& path = recent[i];
        const bool gone = is_gone(path, recent);
        ImGui::PushID(int(i));
        const float width = ImGui::GetContentRegionAvail().x - (gone ? cross + ImGui::GetStyle().ItemSpacing.x : 0.0f);
        const ImVec2 at = ImGui::GetCursorPos();
        if (ImGui::Selectable("##recent", false, gone ? ImGuiSelectableFlags_Disabled : 0, {width, cross}))
            actions.push_back(Open{path});
        if (gone) {
            ImGui::SameLine();
            if (ImGui::Button("x", {cross, cross})) actions.push_back(ForgetRecent{path});
            hint("is no longer there: forget it");
        }
        hint(path.c_str());
        const ImVec2 next = ImGui::GetCursorPos();
        ImGui::SetCursorPos({at.x + 4.0f, at.y + 0.5f * (cross - ImGui::GetTextLineHeight())});
        const std::string name = shortened(path.filename().string(), 0.6f * width) + (gone ? "   (gone)" : "");
        if (gone)
            ImGui::TextDisabled("%s", name.c_str());
        else
            ImGui::TextUnformatted(name.c_str());
        ImGui::SameLine();
        const float room = width - (ImGui::GetCursorPosX() - at.x) - 4.0f;
        ImGui::TextDisabled("%s", shortened(path.parent_path().string(), room).c_str());
        ImGui::SetCursorPos(next);
        ImGui::PopID();
    }
}

}  // namespace

bool choosers_have_keys()
{
    return FileChooser::has_keys();
}

bool choosers_are_busy()
{
    return FileChooser::is_busy() || task_dialog_waits() || load_dialog_waits();
}

void open_dialog(const Model& model, Actions& actions)
{
    static bool was_asked = false;
    if (model.asks_what_to_open && !std::exchange(was_asked, true)) {
        // At first, the dialog starts in the folder of the last opened file or, without one, in the working folder;
        // later, in the folder where it was left.
        static bool was_shown = false;
        const auto& recent = model.preferences.recent;
        const auto is_here = [](const std::filesystem::path& path) { return !is_typed_address(path.string()); };
        const auto last = std::ranges::find_if(recent, is_here);
        std::error_code ignored;
        std::filesystem::path begin = std::filesystem::current_path(ignored);
        if (std::exchange(was_shown, true))
            begin.clear();
        else if (last != recent.end())
            begin = last->parent_path();
        else if (!begin.has_relative_path())
            begin.clear();  // started from a desktop, not in a folder that a person chose
        opening.ask(begin, places_of(model));
    }
    if (!model.asks_what_to_open && std::exchange(was_asked, false) && opening.is_open()) opening.close();
    static std::filesystem::path chosen;  // path chosen last; if it cannot be opened, the dialog asks again
    if (!chosen.empty() && model.failed_path && *model.failed_path == chosen) {
        opening.ask_again(std::exchange(chosen, {}), places_of(model), std::string(model.open_failure));
        was_asked = true;
        actions.push_back(AskOpen{true});
    } else if (model.opening.empty() && model.is_open && model.session.volume_path == chosen) {
        chosen.clear();
    }
    if (const auto path = opening.draw()) {
        chosen = *path;
        actions.push_back(Open{*path});
    }
    if (was_asked && !opening.is_open()) {
        was_asked = false;
        actions.push_back(AskOpen{false});
    }
}

std::optional<std::filesystem::path> answer_of(FileChooser& chooser, Dialog dialog, const std::filesystem::path& begin,
                                               const Model& model, Actions& actions)
{
    static std::map<Dialog, bool> was_asked;
    bool& is_asked = was_asked[dialog];
    if (model.dialog == dialog && !std::exchange(is_asked, true)) chooser.ask(begin, places_of(model));
    if (model.dialog != dialog && std::exchange(is_asked, false) && chooser.is_open()) chooser.close();
    const auto path = chooser.draw();
    if (is_asked && !chooser.is_open()) {
        is_asked = false;
        actions.push_back(ShowDialog{});
    }
    return path;
}

/// Suggests a name next to the session or, if nothing can be written there, in the home folder.
static std::filesystem::path suggested_name(const Model& model)
{
    const std::filesystem::path beside =
        std::filesystem::path(model.session_path).replace_extension().string() + "-2.json";
    return model.is_trouble_of_folder ? home_folder() / beside.filename() : beside;
}

void name_and_take_dialogs(const Model& model, Actions& actions)
{
    const std::filesystem::path copy = suggested_name(model);
    if (const auto path = answer_of(saving, Dialog::save_as, copy, model, actions)) actions.push_back(SaveAs{*path});
    if (const auto path = annotating.draw()) actions.push_back(WorkOnCopy{*path});
    if (const auto path = labelled.draw())
        actions.push_back(TakeFile{*path, labels_of_scan.string() + "\n", FileUse::scan});
    load_preview_dialog(model, actions);
}

void ask_for_session_of_remote(const Model& model)
{
    annotating.ask(model.session_path, places_of(model));
}

void ask_for_scan_of_labels(const Model& model)
{
    labels_of_scan = model.session.volume_path;
    labelled.ask(model.session.volume_path.parent_path() / "", places_of(model));
}

void start_page(const Model& model, Actions& actions)
{
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(40.0f * font, ImGui::GetMainViewport()->WorkSize.x), 0.0f});
    ImGui::Begin("Start", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::TextUnformatted("SHVR");
    ImGui::SameLine();
    ImGui::TextDisabled("look at, paint and trace volumes");
    ImGui::Spacing();
    if (ImGui::Button(("Open..." + key_in_brackets("open", model.keymap)).c_str(), {12.0f * font, 0.0f}))
        actions.push_back(AskOpen{true});
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("a scan of your own, or drop it here");
    hint((names_of_formats("or") +
          "; a folder of slices, a session, a project or the address of an OME-Zarr. Voxels without a header: File, "
          "Open with options.")
             .c_str());
    if (ImGui::Button("Open the example", {12.0f * font, 0.0f})) actions.push_back(OpenExample{});
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("small vessels, made by the program, to try things on");
    if (!model.opening.empty()) {
        ImGui::Spacing();
        ImGui::TextUnformatted(("Opening " + std::string(model.opening) + " ...").c_str());
    } else if (!model.open_failure.empty()) {
        ImGui::Spacing();
        ImGui::PushTextWrapPos(0.0f);
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        ImGui::TextUnformatted(std::string(model.open_failure).c_str());
        ImGui::PopStyleColor();
        ImGui::PopTextWrapPos();
    }
    if (!model.preferences.recent.empty()) {
        ImGui::Spacing();
        ImGui::Separator();
        ImGui::TextDisabled("Opened last");
        recent_list(model, actions);
    }
    ImGui::End();
}

}  // namespace shvr::ui
