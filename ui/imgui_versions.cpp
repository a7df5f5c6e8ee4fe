#include "ui/imgui_versions.h"

#include <algorithm>
#include <cfloat>
#include <limits>
#include <string>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>

#include "engine/base/text.h"

namespace shvr::ui {

namespace {

/// Calls ImGui_ImplVulkan_Init, whose signature depends on the version: later versions have the render pass in `Info`.
template <class Info>
void init_vulkan(Info& info, VkRenderPass pass)
{
    if constexpr (requires { info.RenderPass; }) {
        info.RenderPass = pass;
        ImGui_ImplVulkan_Init(&info);
    } else {
        ImGui_ImplVulkan_Init(&info, pass);
    }
}

/// In Dear ImGui's coordinates.
ImVec2 place_of(const glm::dvec2& pixels)
{
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    return {float(pixels.x) / scale.x, float(pixels.y) / scale.y};
}

/// Decides whether the next press counts as a double click: by the times of events, not by the times of frames.
void allow_double_click(bool is_double)
{
    ImGui::GetIO().MouseDoubleClickTime = is_double ? std::numeric_limits<float>::max() : 0.0f;
}

#if IMGUI_VERSION_NUM >= 19110  // 1.91.1
using ClipboardOwner = ImGuiContext;
auto& clipboard_reader()
{
    return ImGui::GetPlatformIO().Platform_GetClipboardTextFn;
}
#else
using ClipboardOwner = void;
auto& clipboard_reader()
{
    return ImGui::GetIO().GetClipboardTextFn;
}
#endif

}  // namespace

void paste_in_one_line()
{
    static const char* (*clipboard)(ClipboardOwner*) = nullptr;
    clipboard = clipboard_reader();
    clipboard_reader() = [](ClipboardOwner* owner) -> const char* {
        static std::string pasted;
        const char* const text = clipboard(owner);
        if (text) pasted = one_line(text);
        return text ? pasted.c_str() : nullptr;
    };
}

void init_imgui_vulkan(ImGui_ImplVulkan_InitInfo info, VkRenderPass pass)
{
    init_vulkan(info, pass);
}

#if IMGUI_VERSION_NUM >= 19000
void upload_imgui_fonts(VkCommandBuffer)
{
    ImGui_ImplVulkan_CreateFontsTexture();
}

void end_imgui_font_upload() {}
#else
void upload_imgui_fonts(VkCommandBuffer commands)
{
    ImGui_ImplVulkan_CreateFontsTexture(commands);
}

void end_imgui_font_upload()
{
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}
#endif

#if IMGUI_VERSION_NUM >= 18700

namespace {

#if IMGUI_VERSION_NUM >= 18900
constexpr ImGuiKey ALT = ImGuiKey(ImGuiMod_Alt);
#else
constexpr ImGuiKey ALT = ImGuiKey_ModAlt;
#endif

bool is_alt(int key)
{
    return key == GLFW_KEY_LEFT_ALT || key == GLFW_KEY_RIGHT_ALT;
}

/// Returns the pointer's position now. Not for frames with a click, which must use the position of the click.
ImVec2 pointer_of(GLFWwindow* window)
{
    const bool is_here = glfwGetWindowAttrib(window, GLFW_FOCUSED) || glfwGetWindowAttrib(window, GLFW_HOVERED);
    if (!is_here) return {-FLT_MAX, -FLT_MAX};
    glm::dvec2 at(0.0);
    glfwGetCursorPos(window, &at.x, &at.y);
    return {float(at.x), float(at.y)};
}

}  // namespace

/// Makes each frame apply all events queued before it: of two contradicting events, the later one wins. The back end
/// also reports the mouse, but the reports made here come later.
void set_up_imgui_input()
{
    ImGui::GetIO().ConfigInputTrickleEventQueue = false;
}

void tell_imgui_key(GLFWwindow* window, int key, bool pressed, int mods)
{
    if (!is_alt(key)) ImGui_ImplGlfw_KeyCallback(window, key, 0, pressed ? GLFW_PRESS : GLFW_RELEASE, mods);
}

/// Adds the character to the frame's text immediately: code that reads this text would not see a queued event.
void tell_imgui_character(GLFWwindow*, unsigned character)
{
    if (character == 0) return;
    const bool is_known = character <= IM_UNICODE_CODEPOINT_MAX;
    ImGui::GetIO().InputQueueCharacters.push_back(ImWchar(is_known ? character : IM_UNICODE_CODEPOINT_INVALID));
}

void tell_imgui_buttons(GLFWwindow* window, const MouseFeed::Frame& frame)
{
    ImGuiIO& io = ImGui::GetIO();
    const ImVec2 at = frame.at ? place_of(*frame.at) : pointer_of(window);
    io.AddMousePosEvent(at.x, at.y);
    if (frame.at) allow_double_click(frame.is_double);
    for (int button = 0; button < MouseFeed::BUTTONS; ++button)
        io.AddMouseButtonEvent(button, frame.down[size_t(button)]);
}

void begin_imgui_frame(GLFWwindow* window, const FrameKeys& keys, int mods)
{
    for (const int key : keys.pressed) tell_imgui_key(window, key, true, mods);
    ImGui::GetIO().AddKeyEvent(ALT, false);  // otherwise releasing Alt, as after Alt + drag, would move to the menu
    ImGui::NewFrame();
    for (const int key : keys.released) tell_imgui_key(window, key, false, mods);
}

#else

void set_up_imgui_input() {}

void tell_imgui_key(GLFWwindow* window, int key, bool pressed, int mods)
{
    ImGui_ImplGlfw_KeyCallback(window, key, 0, pressed ? GLFW_PRESS : GLFW_RELEASE, mods);
}

void tell_imgui_character(GLFWwindow* window, unsigned character)
{
    ImGui_ImplGlfw_CharCallback(window, character);
}

void tell_imgui_buttons(GLFWwindow*, const MouseFeed::Frame& frame)
{
    ImGuiIO& io = ImGui::GetIO();
    std::copy(frame.down.begin(), frame.down.end(), io.MouseDown);
    if (!frame.at) return;
    io.MousePos = place_of(*frame.at);
    allow_double_click(frame.is_double);
}

void begin_imgui_frame(GLFWwindow*, const FrameKeys& keys, int)
{
    bool(&down)[512] = ImGui::GetIO().KeysDown;
    for (const int key : keys.pressed) down[key] = true;
    ImGui::GetIO().KeyAlt = false;  // otherwise releasing Alt, as after Alt + drag, would move to the menu
    ImGui::NewFrame();
    for (const int key : keys.released) down[key] = false;
}

#endif

}  // namespace shvr::ui
