// The banner that says why the window does not close yet.

#include <imgui/imgui.h>

#include "engine/base/error.h"
#include "ui/panels/banners/banner.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

float closing_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    begin_banner("Closing", begin, width);
    if (ImGui::Button("Cancel it and close"))
        for (const Jobs::State& job : model.jobs) actions.push_back(CancelJob{job.number});
    hint("closes now; what is not written yet is not written");
    ImGui::SameLine();
    if (ImGui::Button("Stay open")) actions.push_back(StayOpen{});
    const std::string what = model.jobs.empty() ? "a file is written" : model.jobs.front().what + " is done";
    ImGui::PushTextWrapPos(0.0f);
    want_glyphs(what);
    ImGui::TextUnformatted(sentence("The window closes once ", what, ".").c_str());
    ImGui::PopTextWrapPos();
    return end_banner();
}

}  // namespace shvr::ui
