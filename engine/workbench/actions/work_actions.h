#pragma once
// Actions on the work: files, history and tasks (engine/tasks).

#include "engine/annotation/script/script.h"
#include "engine/remote/address.h"
#include "engine/tasks/evaluate_task.h"
#include "engine/tasks/export_task.h"
#include "engine/tasks/import_task.h"
#include "engine/tasks/label_task.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class FileTaker;
class Opener;
class Photographer;
class PreferenceKeeper;
class Saver;
class SettingsEditor;
class TaskRunner;

/// Saves and continues under another name, with the whole history; existing files stay unchanged.
struct SaveAs {
    std::filesystem::path path;  ///< the session's new file
};

/// Saves copies of everything shown under other names, without renaming the document. Empty path: next to the session.
struct CopySession {
    std::filesystem::path path;
};

/// Cancels a background job. The tasks of engine/tasks (export, import, label, compare) each run as one job.
struct CancelJob {
    uint64_t number = 0;
};

struct Screenshot {
    bool is_large = false;  ///< larger than the window, by the factor interaction.screenshot_scale of the session
};

/// Opens a file, or a volume at an address, in the background; the open document stays until the new one is loaded.
struct Open {
    std::filesystem::path path;
    std::string settings{};      ///< settings for this opening, one per line, as after --set: "volume.channel=red"
    bool saves_outside = false;  ///< whether the user has agreed that the session may write files outside its folder
};

/// Inspects a file for the open dialog, without reading voxels. The result appears in Model::candidate.
struct LookAtFile {
    std::filesystem::path path;  ///< empty: ends the inspection
    std::string settings{};      ///< as in Open
};

/// How to use a file: as its contents suggest, or as the user states.
enum class FileUse { by_contents, scan, mask, offsets, trace, look, mesh };
inline constexpr Spelling<FileUse> FILE_USES[] = {{FileUse::by_contents, "by_contents"},
                                                  {FileUse::scan, "scan"},
                                                  {FileUse::mask, "mask"},
                                                  {FileUse::offsets, "offsets"},
                                                  {FileUse::trace, "trace"},
                                                  {FileUse::look, "look"},
                                                  {FileUse::mesh, "mesh"}};
constexpr std::span<const Spelling<FileUse>> spellings_of(FileUse)
{
    return FILE_USES;
}

/// Takes a file dropped onto the window. Volumes, sessions, projects and pictures are opened; annotation and transfer
/// functions are added to the open document, as steps that can be undone. The contents decide the kind of file; if they
/// fit both a scan and annotation, the user is asked (Model::unclear_file). If several files are dropped and one of
/// them can be opened, the others are added to that document.
struct TakeFile {
    std::filesystem::path path;
    std::string beside{};  ///< paths of the other files dropped together with this one, one per line
    FileUse use = FileUse::by_contents;
    bool previews = false;  ///< annotation for the open document is previewed (PreviewLoad) instead of added at once
};

/// Adds annotation, a transfer function or a mesh to the open document, as a step that can be undone; opens no
/// document.
struct LoadAnnotation {
    std::filesystem::path path;
    FileUse what = FileUse::by_contents;
};

/// Reads annotation or a transfer function and states what loading it would change (Model::load_preview), without
/// loading it. A LoadAnnotation of the same file then does not read the file again.
struct PreviewLoad {
    std::filesystem::path path;  ///< empty: ends the preview
    FileUse what = FileUse::by_contents;
};

/// Closes the question about the kind of a dropped file, without using the file.
struct DismissUnclearFile {};

/// Corrects the volume's spacing: saves the work, and reopens it with the new spacing. Positions in voxels stay.
struct CorrectSpacing {
    glm::dvec3 spacing{1.0};
    std::string unit;
};

/// Marks the notes about recovered work as read.
struct DismissNotices {};

/// Removes a path from the list of recently opened paths, without touching the file.
struct ForgetRecent {
    std::filesystem::path path;
};

/// Chooses between the annotation in the journal and files that another program changed. Using the files can be undone.
struct ChooseBelief {
    bool takes_files = false;
};

/// Saves everything that is shown under new names, and opens this copy.
struct WorkOnCopy {
    std::filesystem::path path;  ///< session file of the copy; empty: an unused name next to the open session
};

/// What becomes of an import that was cancelled or interrupted (Model::unfinished).
enum class UnfinishedUse { resume, remove, keep };
inline constexpr Spelling<UnfinishedUse> UNFINISHED_USES[] = {
    {UnfinishedUse::resume, "resume"}, {UnfinishedUse::remove, "delete"}, {UnfinishedUse::keep, "keep"}};
constexpr std::span<const Spelling<UnfinishedUse>> spellings_of(UnfinishedUse)
{
    return UNFINISHED_USES;
}

/// Goes on with the unfinished import, deletes what it has left, or keeps that and mentions it no more.
struct SettleImport {
    UnfinishedUse use = UnfinishedUse::keep;
};

/// Opens a copy, owned by the user, of the example that ships.
struct OpenExample {};

inline constexpr const char* WORK_GROUP = "Work";

inline constexpr auto WORK_ACTIONS = std::tuple{
    row<UndoOp, SettingsEditor>({"undo", "Undo", WORK_GROUP, "undoes the last steps of the history"}, NO_FIELDS,
                                [](const auto& model, const UndoOp&) -> std::string {
                                    if (model.is_painting) return IS_PAINTING;
                                    return model.undoable == 0 ? "there is nothing to undo" : why_not_edited(model);
                                }),
    row<RedoOp, SettingsEditor>({"redo", "Redo", WORK_GROUP, "redoes the steps that were undone last"}, NO_FIELDS,
                                [](const auto& model, const RedoOp&) -> std::string {
                                    if (model.is_painting) return IS_PAINTING;
                                    return model.redoable == 0 ? "there is nothing to redo" : why_not_edited(model);
                                }),
    row<SaveOp, Saver>({"save", "Save", WORK_GROUP, "writes mask, offsets, trace and session for other programs"},
                       NO_FIELDS,
                       [](const auto& model, const SaveOp&) -> std::string { return why_not_edited(model); }),
    row<RevertOp, SettingsEditor>(
        {"revert", "Revert", WORK_GROUP, "returns to the last save, as a step that can be undone"}, NO_FIELDS,
        [](const auto& model, const RevertOp&) -> std::string {
            return model.is_painting ? IS_PAINTING : why_not_edited(model);
        }),
    row<SaveAs, Saver>(
        {"save_as", "Save as", WORK_GROUP, "continues under another name, with the whole history"},
        [](auto& f, SaveAs& a) { f.path("path", a.path, {.is_required = true}); },
        [](const auto& model, const SaveAs&) -> std::string {
            return model.is_saving ? IS_SAVING : why_not_edited(model);
        }),
    row<CopySession, Saver>(
        {"copy_session", "Copy the session", WORK_GROUP, "writes everything shown to files of another name"},
        [](auto& f, CopySession& a) { f.path("path", a.path, {}); }),
    row<ExportTask, TaskRunner>(
        {"export", "Export", WORK_GROUP, "writes annotation in formats of other programs, and measurements"},
        TASK_FIELDS,
        // The export dialog checks this condition in each frame, so no disk is accessed here; the task checks the disk.
        [](const auto& model, const ExportTask& task) -> std::string {
            if ((!task.trace.empty() || !task.mesh.empty()) && model.trace.nodes().empty())
                return "nothing is traced yet, so there is neither a trace nor a mesh to write";
            if (task.labels && model.volume.format != "ome-zarr")
                return "labels are written into a project, and this scan is none: import it as one, or name a mask";
            const bool is_painted = std::ranges::any_of(model.voxels_by_group.begin() + 1, model.voxels_by_group.end(),
                                                        [](int64_t voxels) { return voxels > 0; });
            if (!task.surface.empty() && !is_painted) return "nothing is painted yet, so there is no surface to write";
            const bool has_file = std::ranges::any_of(std::array{&task.mask, &task.offset, &task.trace, &task.mesh,
                                                                 &task.metrics, &task.surface, &task.measurements},
                                                      [](const auto* path) { return !path->empty(); });
            return has_file || task.labels ? "" : "no file is named; expected at least one to be written";
        }),
    row<ImportTask, TaskRunner>({"import", "Import as project", WORK_GROUP,
                                 "converts a volume to a project folder, and opens it", Needs::nothing},
                                TASK_FIELDS),
    row<LabelTask, TaskRunner>({"label", "Label connected parts", WORK_GROUP,
                                "counts connected parts above a threshold, and writes their labels"},
                               TASK_FIELDS),
    row<EvaluateTask, TaskRunner>({"evaluate", "Compare with a reference", WORK_GROUP,
                                   "reports how well an annotation agrees with another", Needs::nothing},
                                  TASK_FIELDS),
    row<CancelJob, TaskRunner>(
        {"cancel_job", "Cancel", WORK_GROUP, "cancels a running or waiting job", Needs::nothing},
        [](auto& f, CancelJob& a) { f.whole("number", a.number, 1, int64_t{1} << 53, {.is_required = true}); },
        [](const auto& model, const CancelJob& action) -> std::string {
            for (const auto& job : model.jobs)
                if (job.number == action.number) return {};
            return sentence("there is no job ", action.number);
        }),
    row<Screenshot, Photographer>(
        {"screenshot", "Screenshot", WORK_GROUP, "writes the picture as shown, or a larger one, next to the session"},
        [](auto& f, Screenshot& a) { f.flag("large", a.is_large, {}); }),
    row<Open, FileTaker>(
        {"open", "Open", WORK_GROUP,
         "opens a volume, a session, a project folder, a picture or the address of an OME-Zarr", Needs::nothing},
        [](auto& f, Open& a) {
            f.path("path", a.path, {.allowed = PATH_OR_ADDRESS, .is_required = true});
            f.text("settings", a.settings, {"as --set takes them, one a line"});
            f.flag("saves_outside", a.saves_outside, {"the session may write files outside its folder"});
        }),
    row<LookAtFile, FileTaker>({"look_at_file", "Look at a file", WORK_GROUP,
                                "reads a file's header, and estimates what loading it takes", Needs::nothing},
                               [](auto& f, LookAtFile& a) {
                                   f.path("path", a.path, {.allowed = PATH_OR_ADDRESS});
                                   f.text("settings", a.settings, {"as --set takes them, one a line"});
                               }),
    row<TakeFile, FileTaker>({"take_file", "Take a file", WORK_GROUP,
                              "opens a file, or loads its annotation or transfer function, by its contents; several "
                              "are loaded into the scan among them",
                              Needs::nothing},
                             [](auto& f, TakeFile& a) {
                                 f.path("path", a.path, {.allowed = PATH_OR_ADDRESS, .is_required = true});
                                 f.text("beside", a.beside,
                                        {"paths of the other files in the same drop, one per line"});
                                 f.choice("use", a.use, {"what the file is, if its contents do not state it"});
                                 f.flag("previews", a.previews,
                                        {"states first what annotation of the open scan changes; \"load\" loads it"});
                             }),
    row<LoadAnnotation, FileTaker>(
        {"load", "Load annotation", WORK_GROUP,
         "loads a mask, density offsets, a trace or a transfer function (look) into the open scan, or shows a mesh "
         "with it; opens nothing"},
        [](auto& f, LoadAnnotation& a) {
            f.path("path", a.path, {.is_required = true});
            f.choice("what", a.what, {"what the file is, if its contents do not state it"});
        },
        [](const auto&, const LoadAnnotation& action) -> std::string {
            return action.what == FileUse::scan ? "a scan is opened, not loaded" : "";
        }),
    row<PreviewLoad, FileTaker>(
        {"preview_load", "Preview annotation", WORK_GROUP,
         "states what loading annotation or a transfer function would change, and loads nothing"},
        [](auto& f, PreviewLoad& a) {
            f.path("path", a.path, {});
            f.choice("what", a.what, {"what the file is, if its contents do not state it"});
        },
        [](const auto&, const PreviewLoad& action) -> std::string {
            return action.what == FileUse::scan ? "a scan is opened, not loaded" : "";
        }),
    row<DismissUnclearFile, FileTaker>({"dismiss_unclear_file", "Cancel", WORK_GROUP,
                                        "leaves a dropped file alone that could be scan or annotation", Needs::nothing},
                                       NO_FIELDS,
                                       [](const auto& model, const DismissUnclearFile&) -> std::string {
                                           return model.unclear_file ? "" : "no file is unclear";
                                       }),
    row<CorrectSpacing, Saver>(
        {"correct_spacing", "Correct the spacing", WORK_GROUP,
         "saves, and reopens with another spacing; nodes stay at their voxels"},
        [](auto& f, CorrectSpacing& a) {
            f.vector("spacing", a.spacing, SPACINGS, {.is_required = true});
            f.text("unit", a.unit, {"unit of the spacing; empty: unchanged"});
        },
        [](const auto& model, const CorrectSpacing&) -> std::string {
            return model.session.procedural ? "the volume is computed, and its spacing is the session's"
                                            : why_not_edited(model);
        }),
    row<DismissNotices, Opener>(
        {"dismiss_notices", "Dismiss", WORK_GROUP, "marks the notices shown at opening as read"}, NO_FIELDS,
        [](const auto& model, const DismissNotices&) -> std::string {
            return model.recovered.empty() && model.looks_like_labels.empty() ? "there is nothing to be dismissed" : "";
        }),
    row<ForgetRecent, PreferenceKeeper>(
        {"forget_recent", "Forget", WORK_GROUP, "removes a path from the list of recent files; the file stays",
         Needs::nothing},
        [](auto& f, ForgetRecent& a) { f.path("path", a.path, {.is_required = true}); },
        [](const auto& model, const ForgetRecent& action) -> std::string {
            const auto& recent = model.preferences.recent;
            return std::ranges::find(recent, action.path) != recent.end()
                       ? ""
                       : sentence(action.path.string(), " is not among what was opened last");
        }),
    row<ChooseBelief, SettingsEditor>(
        {"choose_belief", "Files or journal", WORK_GROUP, "chooses whether the changed files or the journal are used"},
        [](auto& f, ChooseBelief& a) { f.flag("files", a.takes_files, {.is_required = true}); },
        [](const auto& model, const ChooseBelief&) -> std::string {
            return model.disputes.empty() ? "no saved file was changed by another program" : "";
        }),
    row<WorkOnCopy, Saver>(
        {"work_on_copy", "Work on a copy", WORK_GROUP, "saves everything shown under new names, and opens the copy"},
        [](auto& f, WorkOnCopy& a) {
            f.path("path", a.path, {"session file of the copy; empty: an unused name next to the open session"});
        },
        [](const auto& model, const WorkOnCopy& action) -> std::string {
            return action.path.empty() && !model.remote.empty()
                       ? "the scan is on another machine; expected path, the session file to make on this one"
                       : "";
        }),
    row<SettleImport, TaskRunner>(
        {"settle_import", "Unfinished import", WORK_GROUP,
         "goes on with an import that was cancelled or interrupted, or deletes what it has left", Needs::nothing},
        [](auto& f, SettleImport& a) { f.choice("use", a.use, {.is_required = true}); },
        [](const auto& model, const SettleImport&) -> std::string {
            return model.unfinished ? "" : "no import was cancelled or interrupted";
        }),
    row<OpenExample, FileTaker>({"open_example", "Open the example", WORK_GROUP,
                                 "opens the supplied example, in a copy of your own", Needs::nothing})};

}  // namespace shvr::ui
