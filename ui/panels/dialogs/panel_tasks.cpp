// Long work: the dialogs in which it is asked for, and how far it is.

#include <cmath>
#include <utility>

#include <imgui/imgui.h>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"
#include "ui/workbench/action_rows.h"

namespace shvr::ui {

namespace {

/// "leaf.swc is there already and is replaced"; empty where nothing is.
template <class Task>
std::string replacement(const Task& task)
{
    std::string names;
    int count = 0;
    if constexpr (requires { replaced_files(task); })
        for (const std::filesystem::path& path : replaced_files(task))
            names += (count++ > 0 ? ", " : "") + path.filename().string();
    return count == 0
               ? ""
               : names + (count == 1 ? " is there already and is replaced" : " are there already and are replaced");
}

/// A dialog with the options of a task. They stay as they were left for the next time with the same scan.
template <class Task>
struct TaskDialog {
    Task task;
    bool is_asked_for = false;

    void draw(const Model& model, const char* verb, Actions& actions)
    {
        if (std::exchange(is_asked_for, false)) ImGui::OpenPopup(Task::TITLE);
        ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
        if (!ImGui::BeginPopupModal(Task::TITLE, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
        const bool has_chooser = draw_fields([&](Fields& f) { fields(f, task); });
        const std::string why = refusal(model);
        if (const std::string replaced = why.empty() ? replacement(task) : ""; !replaced.empty()) {
            ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
            ImGui::TextUnformatted(replaced.c_str());
            ImGui::PopStyleColor();
        } else {
            ImGui::TextDisabled("%s", why.empty() ? " " : why.c_str());
        }
        const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
        ImGui::BeginDisabled(!why.empty());
        if (ImGui::Button(verb, button)) {
            actions.push_back(task);
            ImGui::CloseCurrentPopup();
        }
        ImGui::EndDisabled();
        ImGui::SameLine();
        if (ImGui::Button("Cancel", button) ||
            (!has_chooser && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))))
            ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }

private:
    std::string refusal(const Model& model) const
    {
        try {
            check(task);
            return why_not(model, Action(task));
        } catch (const Error& error) {
            return error.what();
        }
    }
};

struct Dialogs {
    TaskDialog<ExportTask> exporting;
    TaskDialog<ImportTask> importing;
    TaskDialog<LabelTask> labelling;
    TaskDialog<EvaluateTask> evaluating;
};
Dialogs dialogs;

/// What another scan was exported to would be replaced by what this one is.
void forget_another_scan(const Model& model)
{
    static std::filesystem::path session;
    if (session == model.session_path) return;
    session = model.session_path;
    dialogs.exporting.task = {};
    dialogs.importing.task = {};
    dialogs.labelling.task = {};
}

}  // namespace

void ask_to_import(const std::filesystem::path& volume)
{
    dialogs.importing.task.volume = volume;
    dialogs.importing.is_asked_for = true;
}

void task_menu(const Model& model)
{
    forget_another_scan(model);
    load_menu(model);
    if (ImGui::MenuItem("Import as project...")) {
        dialogs.importing.is_asked_for = true;
        if (model.is_open && dialogs.importing.task.volume.empty())
            dialogs.importing.task.volume = model.session.volume_path;
    }
    if (ImGui::MenuItem("Export...", nullptr, false, model.is_open)) dialogs.exporting.is_asked_for = true;
    if (ImGui::MenuItem("Label connected parts...", nullptr, false, model.is_open)) {
        dialogs.labelling.is_asked_for = true;
        dialogs.labelling.task.threshold = model.paint_threshold();
    }
    if (ImGui::MenuItem("Compare with a reference...")) dialogs.evaluating.is_asked_for = true;
}

void task_dialogs(const Model& model, Actions& actions)
{
    load_dialogs(model, actions);
    dialogs.exporting.draw(model, "Export", actions);
    dialogs.importing.draw(model, "Import", actions);
    dialogs.labelling.draw(model, "Label", actions);
    dialogs.evaluating.draw(model, "Compare", actions);
}

void jobs_window(const Model& model, const glm::vec2& lower_middle, Actions& actions)
{
    if (model.jobs.empty()) return;
    ImGui::SetNextWindowPos({lower_middle.x, lower_middle.y - 8.0f}, ImGuiCond_Always, {0.5f, 1.0f});
    ImGui::Begin("Jobs", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
    for (const Jobs::State& job : model.jobs) {
        ImGui::PushID(int(job.number));
        if (ImGui::Button("Cancel")) actions.push_back(CancelJob{job.number});
        ImGui::SameLine();
        ImGui::TextUnformatted((job.stretch.empty() ? job.what : job.stretch).c_str());
        ImGui::SameLine();
        std::string text = job.is_cancelled ? "is being cancelled" : job.is_waiting ? "waits" : job.detail;
        if (job.fraction >= 0.0) text = sentence(std::lround(100.0 * job.fraction), " %  ", text);
        if (job.seconds_left >= 1.0)
            text += sentence(text.empty() ? "" : ", ", duration_text(job.seconds_left), " left");
        if (text.empty()) text = duration_text(job.seconds) + " so far";
        ImGui::TextDisabled("%s", text.c_str());
        ImGui::PopID();
    }
    ImGui::End();
}

}  // namespace shvr::ui
