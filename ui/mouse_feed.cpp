#include "ui/mouse_feed.h"

namespace shvr::ui {

void MouseFeed::add(int button, bool pressed, const glm::dvec2& at, double earliest_s, double latest_s)
{
    if (button >= 0 && button < BUTTONS) waiting_.push_back({button, pressed, at, earliest_s, latest_s});
}

MouseFeed::Frame MouseFeed::next()
{
    Frame frame;
    if (!waiting_.empty()) {
        const Change change = waiting_.front();
        waiting_.pop_front();
        const size_t button = size_t(change.button);
        down_[button] = change.pressed;
        frame.at = change.at;
        if (change.pressed) {
            frame.is_double = change.earliest_s - pressed_s_[button] < DOUBLE_CLICK_S;
            pressed_s_[button] = change.latest_s;
        }
    }
    frame.down = down_;
    return frame;
}

}  // namespace shvr::ui
