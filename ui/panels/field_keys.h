#pragma once
// Tracks the owner of the keyboard. Dear ImGui (1.86) gives the keyboard to a field some frames after the request, and
// reports a frame late that a field has got it or released it. During a heavy picture a frame takes long enough to type
// in: text typed meanwhile would be lost, or act as shortcuts. Main thread.

#include <vector>

#include <imgui/imgui.h>

namespace shvr::ui {

/// Passes the keyboard to one field, with all text typed in the meantime. Between Window::begin_ui and
/// Window::present.
class FieldKeys {
public:
    /// Call before the field. `are_asked_for`: requests the keyboard for it from now on.
    void before_field(bool are_asked_for);
    /// Call when the field is the item drawn last.
    void after_field();
    /// Stores a character typed before the field got the keyboard.
    void type(ImWchar character) { early_.push_back(character); }
    /// Returns whether the keyboard was requested, and the field does not have it yet.
    bool are_awaited() const { return awaited_since_ >= 0; }

private:
    int awaited_since_ = -1;  ///< frame of the request; -1: not awaited
    int last_frame_ = -1;     ///< last frame in which the field was drawn
    bool are_here_ = false;   ///< the field has the keyboard, but not yet the characters typed before
    std::vector<ImWchar> early_;
};

/// Returns whether keys go to a field, after the frame that was drawn last. Between frames.
bool field_has_keys();

}  // namespace shvr::ui
