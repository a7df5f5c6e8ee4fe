// The banner that says why work cannot be saved, with the actions that help.

#include <imgui/imgui.h>

#include "engine/base/error.h"
#include "ui/panels/banners/banner.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Returns what the trouble means for the work that is open.
std::string consequence(const Model& model)
{
    if (!model.is_kept) return "The last changes are in memory only, and would be lost with the program.";
    if (model.kept_window_open && !model.is_saved && model.undoable > 0)
        return "All paint and traces are in the journal: closing without saving leaves them there.";
    if (model.is_trouble_of_folder) return "Save as continues in another folder.";
    return "All paint and traces are in the journal.";
}

}  // namespace

float trouble_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    begin_banner("Not saved", begin, width);
    if (ImGui::Button("Save as...")) actions.push_back(ShowDialog{Dialog::save_as});
    hint("continues under another name, in a folder that can be written to");
    ImGui::SameLine();
    if (ImGui::Button("Try to save")) actions.push_back(SaveOp{});
    if (model.kept_window_open && model.is_kept) {
        ImGui::SameLine();
        if (ImGui::Button("Close without saving")) actions.push_back(Quit{});
    }
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(sentence(model.kept_window_open ? "The window stays open, since not all could be saved: "
                                    : model.is_trouble_of_folder ? "Nothing can be saved: "
                                                                 : "Not saved: ",
                                    model.trouble, ". ", consequence(model))
                               .c_str());
    ImGui::PopTextWrapPos();
    return end_banner();
}

}  // namespace shvr::ui
