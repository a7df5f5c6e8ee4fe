#pragma once
// A click as the answer to a dialog's question "where?": while the window of operations asks for a point, a left click
// in the picture or in a slice moves the probe onto what is seen there, and the window takes the probe's voxel. Main
// thread.

#include <optional>

#include <glm/glm.hpp>

namespace shvr::ui {

class PointTool {
public:
    /// Off: clicks mean what the session's tool says.
    void set_on(bool is_on)
    {
        is_on_ = is_on;
        if (!is_on) frames_ = 0;
    }
    bool is_on() const { return is_on_; }
    /// The viewport asked for the probe to be moved to a click.
    void click() { frames_ = FRAMES; }
    /// Call once for each frame that shows the window. Returns the probe's voxel once the click has moved the probe.
    std::optional<glm::dvec3> take(const glm::dvec3& probe_voxel)
    {
        if (frames_ == 0 || --frames_ > 0) return std::nullopt;
        return probe_voxel;
    }

private:
    static constexpr int FRAMES = 2;  ///< the frame of the click still shows the probe where it was
    bool is_on_ = false;
    int frames_ = 0;
};

/// The only one: there is one mouse.
PointTool& point_tool();

}  // namespace shvr::ui
