// The dialogs that ask for a file to open or to save in.

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/models/preferences.h"
#include "ui/panels/dialogs/file_chooser.h"
#include "ui/panels/panels.h"
#include "ui/thumbnails/thumbnails.h"

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

}  // namespace

bool choosers_have_keys()
{
    return FileChooser::has_keys();
}

bool choosers_are_busy()
{
    return FileChooser::is_busy() || task_dialog_waits() || load_dialog_waits() || thumbnails_are_read() ||
           operations_window_waits();
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

}  // namespace shvr::ui
