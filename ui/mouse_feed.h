#pragma once
// Mouse buttons for Dear ImGui. Version 1.86 polls the state of buttons once a frame: if a frame takes longer than a
// click, two clicks would be taken for one. This class queues presses and releases, and passes one of them to each
// frame, with its position and time. Any thread, one at a time.

#include <array>
#include <deque>
#include <limits>
#include <optional>

#include <glm/vec2.hpp>

namespace shvr::ui {

class MouseFeed {
public:
    static constexpr int BUTTONS = 3;              ///< left, right and middle, as GLFW and Dear ImGui count them
    static constexpr double DOUBLE_CLICK_S = 0.5;  ///< from press to press; most desktops use 0.4 to 0.5 s

    struct Frame {
        std::array<bool, BUTTONS> down{};
        std::optional<glm::dvec2> at;  ///< position of the press or release, in pixels; none: nothing changed
        bool is_double = false;  ///< a press may be the second of a double click, by time; the distance is not checked
    };

    /// Adds a change of a button between `earliest_s` and `latest_s`, which differ if a long frame delayed the input.
    /// Ignores buttons other than left, right and middle.
    void add(int button, bool pressed, const glm::dvec2& at, double earliest_s, double latest_s);
    /// Returns the state for the next frame.
    Frame next();
    /// Returns whether changes are still queued for later frames.
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
