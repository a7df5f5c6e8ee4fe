#pragma once
// The trace: the operations that scripts use, as commands of the one history; selecting and adding by pointing.

#include "engine/workbench/desk/service.h"
#include "engine/workbench/sight/hits.h"

namespace shvr::ui {

class PreferenceKeeper;
class Prober;
struct Services;
class SettingsEditor;
class Viewer;

class Tracer : public Service {
public:
    explicit Tracer(Services& all);
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
    /// Adds a node where tools act. A node that attracts the tools is linked and selected instead.
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

    Viewer& viewer_;
    Prober& prober_;
    SettingsEditor& settings_;
    PreferenceKeeper& keeper_;
};

}  // namespace shvr::ui
