// Why actions would do nothing just now, in words that fit after a colon or into a tooltip.

#include <algorithm>
#include <array>

#include "ui/workbench/action_rows.h"
#include "ui/workbench/preferences.h"
#include "ui/workbench/touch/hand_view.h"

namespace shvr::ui {

namespace {

constexpr const char *IS_PAINTING = "a stroke is being painted", *IS_SAVING = "the work is being saved";

/// What holds for every change of annotation.
std::string why_not_edited(const Model& model)
{
    if (!model.holder.empty()) return sentence("the project is open for writing in ", model.holder);
    if (!model.disputes.empty()) return "saved files were changed by another program: files or journal?";
    if (model.is_saving_as) return "the work is being saved under another name";
    return {};
}

std::string why_not_traced(const Model& model)
{
    return model.is_painting ? IS_PAINTING : why_not_edited(model);
}

std::string why_without_selection(const Model& model)
{
    const std::string why = why_not_traced(model);
    return why.empty() && model.trace.selection().empty() ? "nothing is selected" : why;
}

std::string why_without_node(const Model& model)
{
    const std::string why = why_not_traced(model);
    return why.empty() && !model.trace.selection().node() ? "no node is selected" : why;
}

std::string why_without_group(const Model& model, uint8_t group)
{
    return group == 0 ? "group 0 is the eraser; choose a group from 1 up" : why_not_traced(model);
}

/// An action without a condition of its own.
template <class Kind>
std::string why(const Model&, const Kind&)
{
    return {};
}

std::string why(const Model& model, const ForgetCamera& action)
{
    return model.session.cameras.contains(action.name) ? "" : sentence("no view is kept as ", action.name);
}

std::string why(const Model& model, const RenameCamera& action)
{
    if (!model.session.cameras.contains(action.name)) return sentence("no view is kept as ", action.name);
    return model.session.cameras.contains(action.to) ? sentence("a view is kept as ", action.to, " already") : "";
}

std::string why(const Model& model, const LookAtSelection&)
{
    return model.trace.selection().empty() ? "nothing is selected" : "";
}

std::string why_not_own(const Model& model, const std::string& name)
{
    const auto is_it = [&](const TransferPreset& preset) { return preset.is_own && preset.name == name; };
    return std::ranges::any_of(model.presets, is_it) ? "" : sentence("no transfer function is kept as ", name);
}

std::string why(const Model& model, const KeepPreset&)
{
    return model.session.transfer_function.points().size() < 2 ? "there is no transfer function" : "";
}

std::string why(const Model& model, const RenamePreset& action)
{
    return why_not_own(model, action.name);
}

std::string why(const Model& model, const ForgetPreset& action)
{
    return why_not_own(model, action.name);
}

std::string why(const Model& model, const ComparePasses& action)
{
    return action.path.empty() && !model.compared_passes ? "they are compared with nothing" : "";
}

std::string why(const Model& model, const UpdateOcclusion&)
{
    return model.session.light.occlusion.strength > 0.0 ? "" : "ambient occlusion is off: its strength is 0";
}

std::string why(const Model& model, const Paint& action)
{
    if (!action.on) return {};
    if (model.tool() == Tool::trace) return why_without_group(model, model.brush().group);
    return model.stroke_is_open ? IS_PAINTING : why_not_edited(model);
}

std::string why(const Model& model, const PaintOp&)
{
    return model.is_painting ? IS_PAINTING : why_not_edited(model);
}

std::string why(const Model& model, const DragNode& action)
{
    return action.on ? why_without_node(model) : std::string();
}

std::string why(const Model& model, const NodeOp& action)
{
    if (action.divides && !model.trace.internodes().contains(*action.divides))
        return sentence("there is no internode ", *action.divides);
    if (action.divides && !action.group) return why_not_traced(model);
    return why_without_group(model, action.group.value_or(model.brush().group));
}

std::string why(const Model& model, const SelectOp&)
{
    if (model.is_painting) return IS_PAINTING;
    return model.trace.nodes().empty() ? "there is no node" : "";
}

std::string why(const Model& model, const SelectSegmentOp&)
{
    if (model.is_painting) return IS_PAINTING;
    return model.trace.selection().empty() ? "nothing is selected" : "";
}

std::string why(const Model& model, const DeselectOp&)
{
    return model.trace.selection().empty() ? "nothing is selected" : "";
}

std::string why(const Model& model, const LinkOp&)
{
    return why_without_node(model);
}

std::string why(const Model& model, const MoveOp&)
{
    return why_without_node(model);
}

std::string why(const Model& model, const DeleteOp&)
{
    return why_without_selection(model);
}

std::string why(const Model& model, const GroupOp& action)
{
    return action.group == 0 ? "group 0 is the eraser, and what is traced belongs to a group from 1 up"
                             : why_without_selection(model);
}

std::string why(const Model& model, const RadiusOp& action)
{
    return action.of == RadiusOp::Of::selected ? why_without_selection(model) : why_not_traced(model);
}

std::string why(const Model& model, const NodeAt&)
{
    return why_without_group(model, model.brush().group);
}

std::string why(const Model& model, const SelectAt&)
{
    return model.is_painting ? IS_PAINTING : "";
}

std::string why(const Model& model, const StepNode&)
{
    if (model.is_painting) return IS_PAINTING;
    return model.trace.nodes().empty() ? "there is no node" : "";
}

std::string why(const Model& model, const MendCut&)
{
    const std::string why = why_not_traced(model);
    return why.empty() && !model.is_cut ? "the last deletion cut nothing in two" : why;
}

std::string why(const Model& model, const ClearMeasurements&)
{
    return model.measurements.empty() && !model.measuring_from ? "nothing is measured" : "";
}

std::string why(const Model& model, const CopyMeasurements&)
{
    return model.measurements.empty() ? "nothing is measured" : "";
}

std::string why(const Model& model, const UndoOp&)
{
    if (model.is_painting) return IS_PAINTING;
    return model.undoable == 0 ? "there is nothing to undo" : why_not_edited(model);
}

std::string why(const Model& model, const RedoOp&)
{
    if (model.is_painting) return IS_PAINTING;
    return model.redoable == 0 ? "there is nothing to redo" : why_not_edited(model);
}

std::string why(const Model& model, const SaveOp&)
{
    return why_not_edited(model);
}

std::string why(const Model& model, const RevertOp&)
{
    return model.is_painting ? IS_PAINTING : why_not_edited(model);
}

std::string why(const Model& model, const SaveAs&)
{
    return model.is_saving ? IS_SAVING : why_not_edited(model);
}

/// Asked in each frame of its dialog, so by what is known without the disk; the task itself asks that.
std::string why(const Model& model, const ExportTask& task)
{
    if ((!task.trace.empty() || !task.mesh.empty()) && model.trace.nodes().empty())
        return "nothing is traced yet, so there is neither a trace nor a mesh to write";
    if (task.labels && model.volume.format != "ome-zarr")
        return "labels are written into a project, and this scan is none: import it as one, or name a mask";
    const bool has_file =
        std::ranges::any_of(std::array{&task.mask, &task.offset, &task.trace, &task.mesh, &task.metrics},
                            [](const auto* path) { return !path->empty(); });
    return has_file || task.labels ? "" : "no file is named; expected at least one to be written";
}

std::string why(const Model& model, const CorrectSpacing&)
{
    return model.session.procedural ? "the volume is computed, and its spacing is the session's"
                                    : why_not_edited(model);
}

std::string why(const Model& model, const DismissNotices&)
{
    return model.recovered.empty() ? "there is nothing to be dismissed" : "";
}

std::string why(const Model& model, const CancelJob& action)
{
    for (const Jobs::State& job : model.jobs)
        if (job.number == action.number) return {};
    return sentence("there is no job ", action.number);
}

std::string why(const Model& model, const ForgetRecent& action)
{
    const auto& recent = model.preferences.recent;
    return std::ranges::find(recent, action.path) != recent.end()
               ? ""
               : sentence(action.path.string(), " is not among what was opened last");
}

std::string why(const Model& model, const ChooseBelief&)
{
    return model.disputes.empty() ? "no saved file was changed by another program" : "";
}

std::string why(const Model& model, const GrabVolume& action)
{
    return !action.on || (model.hand && model.hand->moves_probe) ? "" : "no stylus moves the probe";
}

std::string why(const Model& model, const UseDevice& action)
{
    if (action.device.empty()) return {};
    const auto& devices = model.hand ? model.hand->devices : std::vector<DeviceListing>();
    return std::ranges::find(devices, action.device, &DeviceListing::id) != devices.end()
               ? ""
               : sentence("no device ", action.device, " is plugged in");
}

std::string why(const Model& model, const CalibrateDevice&)
{
    return model.hand && model.hand->moves_probe ? "" : "no haptic device moves the probe";
}

std::string why(const Model& model, const RecordStylus&)
{
    return model.hand && model.hand->recorded_s ? "the stylus is being recorded" : "";
}

std::string why(const Model& model, const StopRecording&)
{
    return model.hand && model.hand->recorded_s ? "" : "nothing is being recorded";
}

std::string why(const Model& model, const FollowStylus&)
{
    return model.is_painting ? IS_PAINTING : why_not_edited(model);
}

template <class Kind, class... Others>
constexpr bool IS_ONE_OF = (std::is_same_v<Kind, Others> || ...);
template <class Kind>
constexpr bool NEEDS_DOCUMENT =
    !IS_ONE_OF<Kind, Open, OpenExample, LookAtFile, TakeFile, AskOpen, ForgetRecent, ImportTask, EvaluateTask,
               CancelJob, ChooseKeys, BindKeys, Resize, AwaitKey, ShowHelp, ShowMessages, ShowPalette, Prefer,
               ShowPreferences, FocusOn, ShowFullScreen, Quit>;

}  // namespace

bool waits_for_strokes(const Model& model, const Action& action)
{
    return model.is_painting && !model.stroke_is_open && why_not(model, action) == IS_PAINTING;
}

std::string why_not(const Model& model, const Action& action)
{
    return std::visit(
        [&]<class Kind>(const Kind& kind) -> std::string {
            if (NEEDS_DOCUMENT<Kind> && !model.is_open) return "nothing is open";
            return why(model, kind);
        },
        action);
}

}  // namespace shvr::ui
