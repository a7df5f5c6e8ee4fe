// Long tasks: the dialogs that start them, and their progress.

#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <utility>

#include <imgui/imgui.h>

#include "engine/base/progress.h"
#include "engine/workbench/actions/action_rows.h"
#include "ui/files/asked.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Returns a warning such as "leaf.swc exists and will be replaced"; empty if no file is replaced.
template <class Task>
std::string replacement(const Task& task)
{
    std::string names;
    int count = 0;
    if constexpr (requires { replaced_files(task); })
        for (const std::filesystem::path& path : replaced_files(task))
            names += (count++ > 0 ? ", " : "") + path.filename().string();
    return count == 0 ? "" : names + (count == 1 ? " exists and will be replaced" : " exist and will be replaced");
}

/// Result of checking a task on disk.
struct Verdict {
    std::string refusal;      ///< reason why the task is unavailable; empty: it is available
    std::string replacement;  ///< what it replaces
};

template <class Task>
Verdict verdict_on(const Task& task)
{
    try {
        check(task);
    } catch (const std::exception& error) {
        return {error.what(), {}};
    }
    return {{}, replacement(task)};
}

template <class Task>
constexpr bool WRITES_FILES = !std::is_same_v<Task, EvaluateTask>;

constexpr const char* WAITS = "Waiting for the disk";
int waits_in_frame = -1;  ///< last frame in which a dialog waited for the disk

/// A dialog with the options of a task; the options are kept for the next use with the same scan.
template <class Task>
struct TaskDialog {
    Task task;
    bool is_asked_for = false;

    void draw(const Model& model, const char* verb, Actions& actions)
    {
        const bool begins = std::exchange(is_asked_for, false);
        if (begins) ImGui::OpenPopup(Task::TITLE);
        ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
        if (!ImGui::BeginPopupModal(Task::TITLE, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
        const bool has_chooser = draw_fields([&](Fields& f) { fields(f, task); }, beside(model), begins);
        const std::string why = refusal(model);
        if (why.empty() && !known_.replacement.empty()) {
            ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
            ImGui::TextUnformatted(known_.replacement.c_str());
            ImGui::PopStyleColor();
        } else {
            ImGui::TextDisabled("%s", why.empty() ? " " : why.c_str());
        }
        const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
        // Enter takes effect once the disk has answered for the options as typed before Enter.
        if (begins) is_entered_ = false;
        if (!has_chooser && enter_confirms()) is_entered_ = true;
        const bool confirms = std::exchange(is_entered_, is_entered_ && why == WAITS) && why.empty();
        ImGui::BeginDisabled(!why.empty());
        if (ImGui::Button(verb, button) || confirms) {
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
    /// Names output files after the scan, next to its session or file. Empty for comparisons, which write no files.
    static std::filesystem::path beside(const Model& model)
    {
        if (!model.is_open || !WRITES_FILES<Task>) return {};
        std::filesystem::path path = model.session_path;
        if (path.parent_path().filename() == "shvr") path = path.parent_path().parent_path();  // of a project
        path.replace_extension();
        for (const char* half : {".session", ".nii", ".ome"})  // of scan.nii.gz and scan.ome.tif
            if (path.extension() == half) path.replace_extension();
        return path;
    }
    std::string refusal(const Model& model)
    {
        const std::string why = why_not(model, Action(task));
        if (!why.empty()) return why;
        ask_disk();
        if (is_known_) return known_.refusal;
        return asked_.is_pending() ? WAITS : "";
    }
    /// Checks the task's files in the background: after each change, and every second, since files come and go.
    void ask_disk()
    {
        constexpr double AGAIN_S = 1.0;
        const std::string now = line_of(Action(task));
        const bool is_other = now != asked_of_;
        if (is_other || (!asked_.is_pending() && ImGui::GetTime() - asked_s_ > AGAIN_S)) {
            asked_ = Asked<Verdict>([task = task] { return verdict_on(task); });
            asked_of_ = now;
            asked_s_ = ImGui::GetTime();
            is_known_ = is_known_ && !is_other;
        }
        if (std::optional<Verdict> verdict = asked_.take(is_other ? AT_ONCE : std::chrono::milliseconds())) {
            known_ = std::move(*verdict);
            is_known_ = true;
        }
        if (asked_.is_pending()) waits_in_frame = ImGui::GetFrameCount();
    }

    Asked<Verdict> asked_;
    Verdict known_;
    bool is_entered_ = false;  ///< Enter was pressed, and the answer of the disk is still awaited
    bool is_known_ = false;    ///< `known_` answers for the current task
    std::string asked_of_;
    double asked_s_ = 0.0;
};

struct Dialogs {
    TaskDialog<ExportTask> exporting;
    TaskDialog<ImportTask> importing;
    TaskDialog<LabelTask> labelling;
    TaskDialog<EvaluateTask> evaluating;
};
Dialogs dialogs;

/// Resets the tasks when another scan is opened, since the tasks' file names are those of files of the previous scan.
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

bool task_dialog_waits()
{
    return waits_in_frame == ImGui::GetFrameCount();
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
