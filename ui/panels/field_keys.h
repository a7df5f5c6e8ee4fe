#pragma once
// Tracks which widget has the keyboard. Dear ImGui (1.86) gives the keyboard to a field some frames after the request,
// and reports with a frame's delay that a field has got or released it. The frames of a heavy picture are long enough
// to type in: text typed meanwhile would be lost, or act as shortcuts. Main thread.

#include <vector>

#include <imgui/imgui.h>

namespace shvr::ui {

/// Gives the keyboard to one field, with all text typed since the request. Between Window::begin_ui and
/// Window::present.
class FieldKeys {
public:
    /// Call before drawing the field. `are_asked_for`: requests the keyboard for the field.
    void before_field(bool are_asked_for);
    /// Call directly after drawing the field, which must be Dear ImGui's last item.
    void after_field();
    /// Stores a character typed before the field got the keyboard.
    void type(ImWchar character) { early_.push_back(character); }
    /// Returns whether the field was promised the keyboard and does not have it yet.
    bool are_awaited() const { return awaited_since_ >= 0; }

private:
    int awaited_since_ = -1;  ///< frame of the request; -1: not awaited
    int last_frame_ = -1;     ///< last frame in which the field was drawn
    bool are_here_ = false;   ///< the field has the keyboard, but has not yet received the characters typed before
    std::vector<ImWchar> early_;
};

/// Returns whether keys go to a text field, according to the last drawn frame. Call between frames.
bool field_has_keys();
/// Returns whether a dialog is shown that must be answered first, after the frame that was drawn last. Between frames.
bool dialog_is_shown();

}  // namespace shvr::ui
