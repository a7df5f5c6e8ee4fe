// Notices for the user before work begins: another process is writing the project, or saved files were changed.

#include <optional>

#include <imgui/imgui.h>

#include "ui/panels/banners/banner.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* QUESTION = "Saved annotation was changed by another program";
constexpr const char* UNCLEAR = "Scan or annotation?";

/// Lists work that was recovered or set aside, until the user dismisses the banner. Returns its height.
float recovered_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    begin_banner("Recovered", begin, width);
    if (ImGui::Button("Dismiss")) actions.push_back(DismissNotices{});
    ImGui::PushTextWrapPos(0.0f);
    for (const std::string& text : model.recovered) ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    return end_banner();
}

/// Draws the read-only banner at the upper left of the graphics window, as wide as its text. Returns its height.
float read_only_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    begin_banner("Read only", begin, width);
    const bool is_outside = !model.outside.empty();
    if (ImGui::Button("Work on a copy")) actions.push_back(WorkOnCopy{});
    ImGui::SameLine();
    if (ImGui::Button(is_outside ? "Write there" : "Try again"))
        actions.push_back(Open{.path = model.session_path, .saves_outside = is_outside});
    ImGui::PushTextWrapPos(0.0f);
    const std::string_view why = is_outside ? model.outside : model.holder;
    ImGui::Text("Read only: %s %.*s. Nothing that is changed here is saved.",
                is_outside ? "this session writes files outside its folder:" : "open for writing in", int(why.size()),
                why.data());
    ImGui::PopTextWrapPos();
    return end_banner();
}

/// Draws the banner over a volume at an address. Returns its height.
float remote_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    begin_banner("On another machine", begin, width);
    if (ImGui::Button("Import as project...")) ask_to_import(model.session.volume_path, actions);
    hint("copies the volume to this machine, and opens the copy");
    ImGui::SameLine();
    if (ImGui::Button("Annotate without a copy...")) ask_for_session_of_remote(model);
    hint("makes a session on this machine that names the address and keeps the annotation");
    ImGui::SameLine();
    if (ImGui::Button("Try again")) actions.push_back(Open{.path = std::filesystem::path(model.remote)});
    ImGui::PushTextWrapPos(0.0f);
    ImGui::Text("Read only: %.*s lies on another machine. Nothing that is changed here is saved.",
                int(model.remote.size()), model.remote.data());
    ImGui::PopTextWrapPos();
    return end_banner();
}

/// Says that the open file looks like annotation, and offers to load it as such. Returns its height.
float labels_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    begin_banner("Labels", begin, width);
    if (ImGui::Button("Open its scan...")) ask_for_scan_of_labels(model);
    ImGui::SameLine();
    if (ImGui::Button("Dismiss")) actions.push_back(DismissNotices{});
    const std::string_view why = model.looks_like_labels;
    ImGui::PushTextWrapPos(0.0f);
    ImGui::Text(
        "%s looks like a label image, not like a scan: %.*s. Open the scan that it belongs to, and it is loaded "
        "there as the mask.",
        model.session.volume_path.filename().c_str(), int(why.size()), why.data());
    ImGui::PopTextWrapPos();
    return end_banner();
}

/// The session about which the question was put off; empty: none.
std::filesystem::path put_off;

/// Says, after the question was put off, that nothing is saved until it is answered. Returns its height.
float put_off_banner(const glm::vec2& begin, float width)
{
    begin_banner("Put off", begin, width);
    if (ImGui::Button("Decide now...")) put_off.clear();
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(
        "Nothing can be painted, traced or saved until you have decided which annotation is right: the saved files "
        "that another program changed, or the work in the journal.");
    ImGui::PopTextWrapPos();
    return end_banner();
}

void question_of_belief(const Model& model, Actions& actions)
{
    if (model.disputes.empty() || put_off == model.session_path) return;
    if (!ImGui::IsPopupOpen(QUESTION)) ImGui::OpenPopup(QUESTION);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({40.0f * ImGui::GetFontSize(), 0.0f});
    if (!begin_dialog(QUESTION, ImGuiWindowFlags_AlwaysAutoResize)) return;
    ImGui::PushTextWrapPos(0.0f);
    for (const Dispute& dispute : model.disputes) ImGui::TextUnformatted(dispute.text.c_str());
    ImGui::TextUnformatted("Both are kept, whichever is taken.");
    ImGui::PopTextWrapPos();
    const bool takes_files = ImGui::Button("Take the files, as a step that undo takes back");
    const bool takes_journal = ImGui::Button("Keep the work; the next save keeps the files under other names");
    const bool is_put_off = ImGui::Button("Decide later, and look at the scan first");
    if (takes_files || takes_journal) actions.push_back(ChooseBelief{takes_files});
    if (is_put_off) put_off = model.session_path;
    if (takes_files || takes_journal || is_put_off) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

/// Asks how to use a file that may be annotation: as the mask, as density offsets, or as another scan.
void question_of_use(const Model& model, Actions& actions)
{
    if (!model.unclear_file) return;
    const UnclearFile& file = *model.unclear_file;
    if (!ImGui::IsPopupOpen(UNCLEAR)) ImGui::OpenPopup(UNCLEAR);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({40.0f * ImGui::GetFontSize(), 0.0f});
    if (!begin_dialog(UNCLEAR, ImGuiWindowFlags_AlwaysAutoResize)) return;
    ImGui::PushTextWrapPos(0.0f);
    ImGui::Text("%s %s.", file.path.c_str(), file.why.c_str());
    ImGui::PopTextWrapPos();
    std::optional<Action> chosen;
    const auto button = [&](const char* name, FileUse use) {
        if (!ImGui::Button(name)) return;
        chosen = TakeFile{file.path, file.beside, use, true};
    };
    button("Load as the mask", FileUse::mask);
    if (file.may_be_offsets) button("Load as density offsets", FileUse::offsets);
    if (file.may_be_scan) button("Open as another scan", FileUse::scan);
    if (ImGui::Button("Cancel")) chosen = DismissUnclearFile{};
    if (chosen) {
        actions.push_back(*chosen);
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

}  // namespace

float notices(const Model& model, const glm::vec2& begin, float width, Actions& actions)
{
    float top = begin.y;
    if (!model.remote.empty())
        top += remote_banner(model, begin, width, actions);
    else if (!model.holder.empty() || !model.outside.empty())
        top += read_only_banner(model, begin, width, actions);
    if (model.disputes.empty()) put_off.clear();
    if (!put_off.empty() && put_off == model.session_path) top += put_off_banner({begin.x, top}, width);
    if (!model.trouble.empty()) top += trouble_banner(model, {begin.x, top}, width, actions);
    if (model.unfinished) top += unfinished_banner(model, {begin.x, top}, width, actions);
    if (!model.looks_like_labels.empty()) top += labels_banner(model, {begin.x, top}, width, actions);
    if (!model.recovered.empty()) top += recovered_banner(model, {begin.x, top}, width, actions);
    // Lies over the picture, which keeps its size: a movie leaves the device little time to draw it again.
    if (model.waits_to_close) closing_banner(model, {begin.x, top}, width, actions);
    question_of_belief(model, actions);
    question_of_use(model, actions);
    return top - begin.y;
}

}  // namespace shvr::ui
