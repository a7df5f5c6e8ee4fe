#pragma once
// Hides differences between the supported versions of Dear ImGui: 1.86 (Debian 12) and 1.90 (Debian 13, Ubuntu 24.04).
// In 1.86, a program writes the state of keys and buttons before each frame; since 1.87, it passes events, which Dear
// ImGui applies in NewFrame. With these functions, a frame sees the same state in both versions: that of 1.86.
//
// Main thread only.

#include <vector>

#include <backends/imgui_impl_vulkan.h>
#include <imgui/imgui.h>

#include "ui/mouse_feed.h"

struct GLFWwindow;

namespace shvr::ui {

#if IMGUI_VERSION_NUM >= 19200
#error "expected Dear ImGui 1.86 to 1.91: later ones handle fonts in another way"
#endif

/// Call after ImGui::CreateContext.
void set_up_imgui_input();
/// Pastes texts of several lines with blanks between them: fields have one line, and Dear ImGui would join the words at
/// line ends. Call after ImGui_ImplGlfw_InitForVulkan.
void paste_in_one_line();
/// Reports a pressed or released key. `mods`: as in GLFW.
void tell_imgui_key(GLFWwindow* window, int key, bool pressed, int mods);
void tell_imgui_character(GLFWwindow* window, unsigned character);
/// Reports the state of the buttons, and the pointer's position at a change. Call after ImGui_ImplGlfw_NewFrame.
void tell_imgui_buttons(GLFWwindow* window, const MouseFeed::Frame& frame);
/// The keys that were reported as pressed or released since the previous frame.
struct FrameKeys {
    std::vector<int> pressed;
    std::vector<int> released;  ///< and not pressed again

    void add(int key, bool is_pressed)
    {
        std::erase(released, key);
        (is_pressed ? pressed : released).push_back(key);
    }
};
/// Calls ImGui::NewFrame with the pressed keys down, even if they were released again. `mods`: modifiers held now.
void begin_imgui_frame(GLFWwindow* window, const FrameKeys& keys, int mods);

/// Calls ImGui_ImplVulkan_Init for drawing in the render pass `pass`.
void init_imgui_vulkan(ImGui_ImplVulkan_InitInfo info, VkRenderPass pass);
/// Creates the font texture: records the upload into `commands`; since 1.90, uploads at once and records nothing.
void upload_imgui_fonts(VkCommandBuffer commands);
/// Call once the recorded upload is done.
void end_imgui_font_upload();

}  // namespace shvr::ui
