#pragma once
// The axis of a flower head, fitted to its trace or stated, and positions relative to it. Any thread may call these.

#include <optional>
#include <string>

#include "engine/annotation/patterns/stated_axis.h"
#include "engine/annotation/patterns/vein_graph.h"

namespace shvr {

struct HeadFrame {
    glm::dvec3 centre{0.0};  ///< on the axis; physical space
    /// Right-handed axes of unit length; `up` points from the stem to the florets.
    glm::dvec3 x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, up{0.0, 0.0, 1.0};
    bool knows_up = true;  ///< false: the trace does not show which end is up, so up.z >= 0
    /// Root mean square angle (weighted by length) between chords of abaxial veins and planes through the axis; null if
    /// the axis was fitted without veins.
    std::optional<double> residual_degrees{};

    /// The axis's direction and place are less wrong than this in 99 of 100 traces; null if it was fitted without veins
    /// or stated.
    struct Error {
        double degrees, length;
        bool is_ambiguous;  ///< another axis fits nearly as well
    };
    std::optional<Error> error{};
    bool is_stated = false;
    /// Distances along x, y and up from the centre.
    glm::dvec3 local(const glm::dvec3& at) const
    {
        const glm::dvec3 p = at - centre;
        return {glm::dot(p, x), glm::dot(p, y), glm::dot(p, up)};
    }
};

struct FoundFrame {
    std::optional<HeadFrame> frame{};
    std::string reason{};  ///< why there is none
};
/// Fits the axis around which the head is symmetrical (head_axis.h). If no abaxial veins lie around an axis, uses the
/// principal axis of inertia whose moment differs most from the other two: of the florets if there are 12 or more,
/// otherwise of all sections; if these are wider to one side, it is no axis, and the errors are large. A stated axis is
/// taken as it is. Time is linear in the number of nodes.
FoundFrame fit_frame(const VeinGraph& graph, const std::optional<StatedAxis>& stated = {});

}  // namespace shvr
