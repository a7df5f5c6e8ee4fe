#pragma once
// The axis of a flower head as a user states it. Any thread may call these.

#include <optional>
#include <string>

#include <glm/glm.hpp>

namespace shvr {

struct StatedAxis {
    glm::dvec3 through;    ///< physical space, as in exported traces
    glm::dvec3 direction;  ///< of unit length, from the stem to the florets
};
/// Reads "X,Y,Z,DX,DY,DZ": a point and a direction. Null if the text is empty; errors begin with `option`.
std::optional<StatedAxis> stated_axis(const std::string& text, const std::string& option);

}  // namespace shvr
