// Long tasks: the dialogs that start them, and their progress.

#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <imgui/imgui.h>

#include "engine/base/progress.h"
#include "engine/tasks/task_output.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/forms/disk_space.h"
#include "engine/workbench/forms/form_names.h"
#include "ui/files/asked.h"
#include "ui/files/file_list.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/dialogs/picture_rows.h"
#include "ui/panels/dialogs/task_rows.h"
#include "ui/panels/number_field.h"
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
    std::string refusal;                ///< reason why the task is unavailable; empty: it is available
    std::vector<std::string> warnings;  ///< what it replaces, and space that it may lack
    KnownScan scan{};                   ///< the scan that an import reads
    std::filesystem::path free_name{};  ///< for a project whose name is taken
};

void add_warning(Verdict& verdict, std::string warning)
{
    if (!warning.empty()) verdict.warnings.push_back(std::move(warning));
}

void judge_space(Verdict& verdict, const BytesNeeded& needed, std::optional<double> free_bytes)
{
    SpaceWords words = words_of_space(needed, free_bytes);
    if (verdict.refusal.empty()) verdict.refusal = std::move(words.refusal);
    add_warning(verdict, std::move(words.warning));
}

/// Returns a file that the task writes; empty: none whose size a form knows.
template <class Task>
std::filesystem::path written_file(const Task& task)
{
    if constexpr (std::is_same_v<Task, ExportTask>) {
        for (const auto& path : {task.mask, task.trace, task.surface})
            if (!path.empty()) return path;
    } else if constexpr (std::is_same_v<Task, LabelTask>) {
        return task.output;
    }
    return {};
}

template <class Task>
void judge(Verdict& verdict, const Task& task, const BytesNeeded& needed)
{
    check(task);
    add_warning(verdict, replacement(task));
    if (const std::filesystem::path file = written_file(task); !file.empty())
        judge_space(verdict, needed, free_space(file));
}

void judge(Verdict& verdict, const ImportTask& task, const BytesNeeded&)
{
    check(task);
    const ImportPlace place = look_at_place(task);
    verdict.refusal = place.why_not;
    verdict.free_name = place.free_name;
    add_warning(verdict, words_of_replacement(task, place));
    // The server of an address is asked once the import begins, not while a person types.
    if (is_typed_address(task.volume.string())) return;
    verdict.scan = estimate_of(task);
    judge_space(verdict, bytes_written(*verdict.scan), verdict.scan->free_bytes);
}

/// `needed`: what the form says that the task writes.
template <class Task>
Verdict verdict_on(const Task& task, const BytesNeeded& needed)
{
    Verdict verdict;
    try {
        judge(verdict, task, needed);
    } catch (const std::exception& error) {
        verdict.refusal = error.what();
    }
    return verdict;
}

template <class Form>
BytesNeeded needed_by(const Form& form, const Model& model)
{
    if constexpr (requires { bytes_written(form, model); }) return bytes_written(form, model);
    return {};
}

constexpr const char* WAITS = "Waiting for the disk";
int waits_in_frame = -1;  ///< last frame in which a dialog waited for the disk

EvaluateTask task_of(const CompareForm& form, const std::filesystem::path&)
{
    return form.task;
}

/// The dialog of a task. Each time that it is shown, it suggests names for the open document.
template <class Form>
class TaskDialog {
public:
    using Task = decltype(task_of(std::declval<const Form&>(), std::filesystem::path()));

    TaskDialog(Dialog dialog, const char* verb) : dialog_(dialog), verb_(verb) {}

    /// `suggested`: the form that it begins with.
    void draw(const Model& model, Actions& actions, const std::function<Form()>& suggested)
    {
        const bool begins = model.dialog == dialog_ && !std::exchange(is_shown_, true);
        if (begins) {
            form_ = suggested();
            is_entered_ = is_refused_ = is_known_ = false;
            asked_of_.clear();  // files may have come and gone since it was last shown
            ImGui::OpenPopup(Task::TITLE);
        }
        if (!is_shown_) return;
        ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
        size_dialog();
        if (!begin_dialog(Task::TITLE, ImGuiWindowFlags_AlwaysAutoResize)) {
            // Another popup closed it.
            is_shown_ = false;
            if (model.dialog == dialog_) actions.push_back(ShowDialog{});
            return;
        }
        const bool takes_keys = std::exchange(is_refused_, false) || begins;
        const bool has_chooser = draw_form(form_, model, known_.scan, takes_keys);
        if constexpr (std::is_same_v<Form, MovieForm>)
            if (std::exchange(form_.keeps_shown, false)) actions.push_back(KeepCamera{.name = {}, .with_look = true});
        const Task task = task_of(form_, base_of(model).parent_path());
        const std::string why = refusal(model, task);
        dialog_note(about(form_, model, known_.scan), why);
        if (why.empty() && is_known_)
            for (const std::string& warning : known_.warnings) dialog_note({}, warning);
        const ImGuiViewport& screen = *ImGui::GetMainViewport();
        keep_above(screen.WorkPos.y + screen.WorkSize.y);
        if (ends(task, why, has_chooser, model, actions) || model.dialog != dialog_) {
            ImGui::CloseCurrentPopup();
            is_shown_ = false;
            if (model.dialog == dialog_) actions.push_back(ShowDialog{});
        }
        ImGui::EndPopup();
    }
    const Form& form() const { return form_; }

private:
    /// Draws the buttons. Returns whether the dialog ends, with the task among the actions if it was confirmed.
    bool ends(const Task& task, const std::string& why, bool has_chooser, const Model& model, Actions& actions)
    {
        const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
        // Enter waits for the disk's answer to what was typed before it.
        if (!has_chooser && enter_confirms()) is_entered_ = true;
        is_refused_ = is_entered_ && !why.empty() && why != WAITS;  // a field lets go of the keyboard at Enter
        const bool confirms = std::exchange(is_entered_, is_entered_ && why == WAITS) && why.empty();
        ImGui::BeginDisabled(!why.empty());
        const bool is_confirmed = ImGui::Button(verb_, button) || confirms;
        ImGui::EndDisabled();
        if (is_confirmed) actions.push_back(task);
        ImGui::SameLine();
        const bool is_cancelled = ImGui::Button("Cancel", button) ||
                                  (!has_chooser && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)));
        return copies(task, model, actions) || is_cancelled || is_confirmed;
    }
    /// Draws the button of figures that puts them into the clipboard. Returns whether it was pressed.
    bool copies(const Task& task, const Model& model, Actions& actions) const
    {
        if constexpr (std::is_same_v<Form, FigureForm>) {
            ImGui::SameLine();
            FigureTask copy = task;
            copy.is_copied = true;
            copy.path.clear();
            std::string wrong = refused_number();
            if (wrong.empty()) wrong = why_not(form_);
            if (wrong.empty()) wrong = why_not(model, Action(copy));
            if (copy_button(wrong)) {
                actions.push_back(copy);
                return true;
            }
        }
        return false;
    }
    std::string refusal(const Model& model, const Task& task)
    {
        if (std::string wrong = refused_number(); !wrong.empty()) return wrong;
        std::string why = why_not(model, Action(task));
        if constexpr (requires { why_not(form_); })
            if (why.empty()) why = why_not(form_);
        if (!why.empty()) return why;
        ask_disk(task, needed_by(form_, model));
        if (!is_known_) return asked_.is_pending() ? WAITS : "";
        return takes_free_name() ? WAITS : known_.refusal;
    }
    /// Checks files in the background: after each change, and again now and then, since files come and go.
    void ask_disk(const Task& task, const BytesNeeded& needed)
    {
        constexpr double AGAIN_S = 1.0;
        const std::string now = line_of(Action(task));
        const bool is_other = now != asked_of_;
        if (is_other || (!asked_.is_pending() && ImGui::GetTime() - asked_s_ > AGAIN_S)) {
            asked_ = Asked<Verdict>([task, needed] { return verdict_on(task, needed); });
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
    /// A suggested project that is there already gets another name: returns whether it did. A typed one is refused.
    bool takes_free_name()
    {
        if constexpr (std::is_same_v<Form, ImportForm>) {
            if (!known_.scan || known_.free_name.empty() || form_.more.overwrite) return false;
            if (form_.project != form_.suggested) return false;
            form_.project = form_.suggested = known_.free_name.string();
            return true;
        }
        return false;
    }

    Dialog dialog_;
    const char* verb_;
    Form form_{};
    bool is_shown_ = false;
    Asked<Verdict> asked_;
    Verdict known_;
    bool is_entered_ = false;  ///< Enter was pressed, and the answer of the disk is still awaited
    bool is_refused_ = false;  ///< Enter was pressed and refused: the first field gets the keyboard again
    bool is_known_ = false;    ///< `known_` answers for the current task
    std::string asked_of_;
    double asked_s_ = 0.0;
};

struct Dialogs {
    TaskDialog<ExportForm> exporting{Dialog::export_work, "Export"};
    TaskDialog<ImportForm> importing{Dialog::import_scan, "Import"};
    TaskDialog<LabelForm> labelling{Dialog::label, "Label"};
    TaskDialog<CompareForm> comparing{Dialog::compare, "Compare"};
    TaskDialog<FigureForm> figure{Dialog::figure, "Save"};
    TaskDialog<MovieForm> movie{Dialog::movie, "Make"};
    std::filesystem::path volume_to_import;  ///< the next import is of this one
};
Dialogs dialogs;

}  // namespace

void ask_to_import(const std::filesystem::path& volume, Actions& actions)
{
    dialogs.volume_to_import = volume;
    actions.push_back(ShowDialog{Dialog::import_scan});
}

void task_menu(const Model& model, Actions& actions)
{
    shortcut_item("open_with_options", model, actions);
    shortcut_item("correct_spacing", model, actions);
    shortcut_item("import_scan", model, actions);
    shortcut_item("export_work", model, actions);
    shortcut_item("label_parts", model, actions);
    shortcut_item("compare", model, actions);
}

void task_dialogs(const Model& model, Actions& actions)
{
    load_dialogs(model, actions);
    dialogs.exporting.draw(model, actions, [&] {
        ExportForm last;
        last.mask.ending = dialogs.exporting.form().mask.ending;
        last.trace.ending = dialogs.exporting.form().trace.ending;
        return suggested_export(model, last);
    });
    dialogs.importing.draw(model, actions,
                           [&] { return suggested_import(model, std::exchange(dialogs.volume_to_import, {})); });
    dialogs.labelling.draw(model, actions, [&] { return suggested_label(model); });
    dialogs.comparing.draw(model, actions, [&] { return dialogs.comparing.form(); });
    dialogs.figure.draw(model, actions, [&] { return suggested_figure(model, dialogs.figure.form()); });
    dialogs.movie.draw(model, actions, [&] { return suggested_movie(model, dialogs.movie.form()); });
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
