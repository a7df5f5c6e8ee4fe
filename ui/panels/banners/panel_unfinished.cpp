// The banner about an import that was cancelled or interrupted.

#include <imgui/imgui.h>

#include "engine/base/error.h"
#include "engine/workbench/forms/form_names.h"
#include "ui/panels/banners/banner.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

float unfinished_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    begin_banner("Unfinished import", begin, width);
    if (ImGui::Button("Resume the import")) actions.push_back(SettleImport{UnfinishedUse::resume});
    hint("goes on from what is done");
    ImGui::SameLine();
    if (ImGui::Button("Delete what is left")) actions.push_back(SettleImport{UnfinishedUse::remove});
    ImGui::SameLine();
    if (ImGui::Button("Keep for later")) actions.push_back(SettleImport{UnfinishedUse::keep});
    hint("the same import goes on from there, whenever it is asked for");
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(sentence("An import was not finished: ", model.unfinished->part.string(), " takes ",
                                    bytes_in_words(model.unfinished->bytes), " of the disk.")
                               .c_str());
    ImGui::PopTextWrapPos();
    return end_banner();
}

}  // namespace shvr::ui
