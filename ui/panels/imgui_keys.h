#pragma once
// Names of keys that differ between versions of Dear ImGui.

#include <imgui/imgui.h>

namespace shvr::ui {

#if IMGUI_VERSION_NUM >= 18700
inline constexpr ImGuiKey KEYPAD_ENTER = ImGuiKey_KeypadEnter;
#else
inline constexpr ImGuiKey KEYPAD_ENTER = ImGuiKey_KeyPadEnter;
#endif

}  // namespace shvr::ui
