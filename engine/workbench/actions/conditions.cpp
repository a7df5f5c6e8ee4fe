#include "engine/workbench/actions/conditions.h"

#include <algorithm>
#include <sstream>
#include <variant>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

std::string why_not_edited(const Model& model)
{
    if (!model.holder.empty()) return sentence("the project is open for writing in ", model.holder);
    if (!model.outside.empty()) return sentence("its session writes outside its folder: ", model.outside);
    if (!model.remote.empty())
        return "the scan lies on another machine: import it as a project, or work on a copy of the session";
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

namespace {

/// `groups`: empty stands for all groups.
std::string why_all_empty(const Model& model, const std::vector<uint8_t>& groups)
{
    const auto is_painted = [&](uint8_t group) { return model.voxels_by_group[group] > 0; };
    const auto has_voxels = [](int64_t voxels) { return voxels > 0; };
    if (groups.empty())
        return std::any_of(model.voxels_by_group.begin() + 1, model.voxels_by_group.end(), has_voxels)
                   ? ""
                   : "no group has voxels";
    if (std::ranges::any_of(groups, is_painted)) return {};
    return groups.size() == 1 ? sentence("group ", int(groups[0]), " has no voxels")
                              : sentence("the groups ", shvr::text_of(groups), " have no voxels");
}

}  // namespace

std::string why_not_operated(const Model& model, const GroupOperation& operation)
{
    const std::string why = why_not_traced(model);
    if (!why.empty()) return why;
    return std::visit(
        [&]<class Op>(const Op& op) -> std::string {
            if constexpr (requires { Op::READS_TRACE; })
                return model.trace.nodes().empty() ? "the trace has no nodes" : "";
            else if constexpr (requires { Op::PAINTS_ONLY; })
                return {};
            else if constexpr (requires { op.groups; })
                return why_all_empty(model, op.groups);
            else if constexpr (requires { op.with; })
                return model.voxels_by_group[size_t(op.group)] + model.voxels_by_group[size_t(op.with)] == 0
                           ? sentence("groups ", op.group, " and ", op.with, " have no voxels")
                           : "";
            else
                return model.voxels_by_group[size_t(op.group)] == 0 ? sentence("group ", op.group, " has no voxels")
                                                                    : "";
        },
        operation);
}

std::string why_not_own(const Model& model, const std::string& name)
{
    const auto is_it = [&](const TransferPreset& preset) { return preset.is_own && preset.name == name; };
    return std::ranges::any_of(model.presets, is_it) ? "" : sentence("no transfer function is kept as ", name);
}

std::string why_not_through(const Model& model, const std::string& views)
{
    const auto projection_of = [&](const std::string& view) {
        const auto kept = model.session.cameras.find(view);
        const Camera* const camera = kept == model.session.cameras.end() ? nullptr : std::get_if<Camera>(&kept->second);
        return camera ? camera->projection : Camera::Projection::perspective;  // as sides are
    };
    std::istringstream lines(views);
    std::string first;
    for (std::string view; std::getline(lines, view);) {
        if (first.empty()) first = view;
        if (projection_of(view) != projection_of(first))
            return sentence(view, " is ", spelled(projection_of(view)), ", and ", first, " is ",
                            spelled(projection_of(first)), "; expected views of the same projection");
    }
    return {};
}

}  // namespace shvr::ui
