#pragma once
// Operations on a trace, in the form that scripts, the window and a stylus share. Positions are voxel coordinates,
// radii are voxels along x.

#include <cstdint>
#include <optional>
#include <variant>

#include <glm/glm.hpp>

namespace shvr {

struct NodeOp {
    glm::dvec3 at{0.0};
    std::optional<double> radius_voxels;  ///< default: the probe's
    std::optional<uint8_t> group;         ///< default: the probe's
    /// An internode to split into two that meet in the new node; the node's radius and group default to the
    /// internode's.
    std::optional<uint32_t> divides{};
};
struct SelectOp {
    std::optional<glm::dvec3> near;  ///< selects the nearest node (or internode of the selected node)
    std::optional<uint32_t> number;  ///< used without `near`
    bool is_internode = false;
    std::optional<double> within_voxels;  ///< greatest distance of the nearest object; default: no limit
};
struct SelectSegmentOp {};
struct DeselectOp {};
struct LinkOp {
    std::optional<glm::dvec3> near;         ///< the nearest other node
    std::optional<uint32_t> node;           ///< used without `near`
    std::optional<double> within_voxels{};  ///< greatest distance of the nearest node; default: no limit
};
struct MoveOp {
    glm::dvec3 to{0.0};
    /// If given, all selected nodes move by `to` - `from`; if only internodes are selected, their ends do. If null, the
    /// selected node moves to `to`.
    std::optional<glm::dvec3> from{};
};
struct DeleteOp {};
struct GroupOp {
    uint8_t group = 1;
};
struct RadiusOp {
    enum class Of { selected, nodes, internodes };
    Of of = Of::selected;                 ///< `nodes` and `internodes`: all of `group`
    std::optional<double> radius_voxels;  ///< null, for internodes only: they taper
    uint8_t group = 0;
};

using TraceOp =
    std::variant<NodeOp, SelectOp, SelectSegmentOp, DeselectOp, LinkOp, MoveOp, DeleteOp, GroupOp, RadiusOp>;

}  // namespace shvr
