#pragma once
// Buttons of the mouse for Dear ImGui, which (1.86) asks for their state once a frame: where a frame takes longer than
// a click, it takes two clicks for one. Here presses wait, and each frame is told one of them, with the place and the
// time at which it happened. Any thread, one at a time.

#include <array>
#include <deque>
#include <limits>
#include <optional>

#include <glm/vec2.hpp>

namespace shvr::ui {

class MouseFeed {
public:
    static constexpr int BUTTONS = 3;              ///< left, right and middle, as GLFW and Dear ImGui count them
    static constexpr double DOUBLE_CLICK_S = 0.5;  ///< from press to press: most desktops take 0.4 to 0.5

    struct Frame {
        std::array<bool, BUTTONS> down{};
        std::optional<glm::dvec2> at;  ///< where the button was pressed or let go of, in pixels; none: nothing changed
        bool is_double = false;  ///< the same button can have been pressed that soon before; not how far from here
    };

    /// Happened at some time between the two: what comes while a long frame is drawn is received after it. Other
    /// buttons are passed over.
    void add(int button, bool pressed, const glm::dvec2& at, double earliest_s, double latest_s);
    /// What the next frame is told.
    Frame next();
    /// Whether a frame after this one has something to be told.
    bool is_waiting() const { return !waiting_.empty(); }

private:
    struct Change {
        int button = 0;
        bool pressed = false;
        glm::dvec2 at{0.0};
        double earliest_s = 0.0, latest_s = 0.0;
    };
    static constexpr double NEVER = -std::numeric_limits<double>::infinity();
    std::deque<Change> waiting_;
    std::array<bool, BUTTONS> down_{};
    std::array<double, BUTTONS> pressed_s_{NEVER, NEVER, NEVER};
};

}  // namespace shvr::ui
