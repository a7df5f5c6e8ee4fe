#include "ui/panels/field_keys.h"

#include <utility>

#include <imgui/imgui_internal.h>

namespace shvr::ui {

namespace {

constexpr int FRAMES_TO_ANSWER = 2;
constexpr int PATIENCE_FRAMES = 7;  ///< frames until a request ends: a field behind a dialog never gets the keyboard
int awaited_in_frame = -1;          ///< last frame in which a field awaited the keyboard

}  // namespace

void FieldKeys::before_field(bool are_asked_for)
{
    const int frame = ImGui::GetFrameCount();
    if (std::exchange(last_frame_, frame) + 1 < frame) {  // the field was not drawn meanwhile, so it lost its state
        awaited_since_ = -1;
        early_.clear();
    }
    if (are_asked_for) {
        awaited_since_ = frame;
        are_here_ = false;
    }
    if (!are_awaited()) return;
    // Repeats the request: Dear ImGui drops a request that is made in the frame in which a dialog closes.
    if (!are_here_ && (frame - awaited_since_) % FRAMES_TO_ANSWER == 0) {
        ImGui::SetWindowFocus();
        ImGui::SetKeyboardFocusHere();
    }
    ImVector<ImWchar>& typed = ImGui::GetIO().InputQueueCharacters;
    early_.insert(early_.end(), typed.begin(), typed.end());
    typed.resize(0);  // a field may ignore text in the frame in which it gets the keyboard
    if (!are_here_ && frame - awaited_since_ <= PATIENCE_FRAMES) return;
    awaited_since_ = -1;
    for (const ImWchar character : std::exchange(early_, {}))
        if (are_here_) typed.push_back(character);
}

void FieldKeys::after_field()
{
    if (!are_awaited()) return;
    are_here_ = ImGui::IsItemActive();
    awaited_in_frame = ImGui::GetFrameCount();
}

bool field_has_keys()
{
    const ImGuiContext& context = *ImGui::GetCurrentContext();
    const ImGuiID active = context.ActiveId;
    const bool is_typed_in = active != 0 && active == context.InputTextState.ID && active == context.ActiveIdIsAlive;
    return is_typed_in || awaited_in_frame == context.FrameCount;
}

bool dialog_is_shown()
{
    return ImGui::GetTopMostPopupModal() != nullptr;
}

}  // namespace shvr::ui
