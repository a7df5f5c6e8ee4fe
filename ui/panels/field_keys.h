#pragma once
// Whose the keys are. Dear ImGui (1.86) hands the keyboard to a field some frames after it is asked to, and tells a
// frame late that a field has it or has let go of it. Beside a heavy picture a frame takes long enough to type in: what
// is typed meanwhile would be lost, or be shortcuts. Main thread.

#include <vector>

#include <imgui/imgui.h>

namespace shvr::ui {

/// The keyboard's way to one field, which all that is typed on the way reaches. Between Window::begin_ui and
/// Window::present.
class FieldKeys {
public:
    /// Before the field. `are_asked_for`: it is to have the keyboard from now on.
    void before_field(bool are_asked_for);
    /// When the field is the item drawn last.
    void after_field();
    /// Typed before its turn came.
    void type(ImWchar character) { early_.push_back(character); }
    /// It was asked for, and the field does not have it yet.
    bool are_awaited() const { return awaited_since_ >= 0; }

private:
    int awaited_since_ = -1;  ///< the frame; -1: not awaited
    int last_frame_ = -1;     ///< that the field was drawn in
    bool are_here_ = false;   ///< the field has the keyboard, and not yet what was typed early
    std::vector<ImWchar> early_;
};

/// Whether keys are for a field, after the frame that was drawn last. Between frames.
bool field_has_keys();

}  // namespace shvr::ui
