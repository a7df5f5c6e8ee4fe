#pragma once
// Carries out operations on the trace as commands of the history, as scripts do; selects and adds nodes by pointing.

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"
#include "engine/workbench/sight/hits.h"

namespace shvr::ui {

class Tracer : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<Pane(size_t index)> pane;
        Call<std::optional<glm::dvec3>(const Pane&, const glm::dvec2& pixel)> seen_at;
        Call<void(const Camera&)> look_from;
        Call<void(const glm::dvec3& point, bool jumps)> move_probe;
        Call<void(const Set&)> set;
        Call<void()> record_settings;
        Call<void(const Command&)> show_changes;
    };
    Tracer(Desk& desk, PreferenceKeeper& keeper, Others others);
    void act(const DragNode& action);
    void act(const NodeOp& op) { trace(op); }
    void act(const SelectOp& op) { trace(op); }
    void act(const SelectSegmentOp& op) { trace(op); }
    void act(const DeselectOp& op) { trace(op); }
    void act(const LinkOp& op) { trace(op); }
    void act(const MoveOp& op) { trace(op); }
    void act(const DeleteOp& op) { trace(op); }
    void act(const GroupOp& op) { trace(op); }
    void act(const RadiusOp& op) { trace(op); }
    void act(const NodeAt& action);
    void act(const SelectAt& action);
    void act(const StepNode& action);
    void act(const MendCut& action);

    void trace(const TraceOp& op);
    /// Adds a node where tools act. If they snap to an existing node, links the selected node to it and selects it.
    void add_node_here();
    TraceModel model() const;

private:
    Actions add_node_at(const Action& action);
    TraceOp with_radius(TraceOp op) const;
    std::optional<ToolPlace> line_at(const Pane& pane, const glm::dvec2& pixel) const;
    bool add_drawn_node(const ToolPlace& place);
    std::optional<uint32_t> node_in_voxel(const glm::dvec3& voxel) const;
    void select_segment();
    void note_cut(std::optional<std::pair<uint32_t, uint32_t>> ends);
    bool is_hidden(const Pane& pane, const glm::dvec2& pixel, const TraceHit& hit) const;

    PreferenceKeeper& keeper_;
    const Others others_;
};

}  // namespace shvr::ui
