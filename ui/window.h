#pragma once
// The window, by GLFW: shows images of the view under the user interface (swapchain.h) and collects input.
//
//     Window window({...});                                  // before the device, which needs its requirements
//     Renderer renderer({.device = window.device_needs()});
//     window.attach(renderer.device(), renderer.memory());
//     while (!window.should_close()) {
//         for (const InputEvent& event : window.wait_events(0.01)) ...
//         window.begin_ui(); ... ImGui calls ...; window.present(layers, origin, {});
//     }
//     window.detach();                                       // before the device is destroyed
//
// The main thread.

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "engine/gpu/memory.h"
#include "engine/live/view.h"

namespace shvr::ui {

struct KeyEvent {
    int key = 0;   ///< GLFW_KEY_*
    int mods = 0;  ///< GLFW_MOD_*
    bool pressed = false;
    bool repeated = false;
    std::string character{};  ///< that it stands for in the person's layout, without modifiers; empty: none, or unknown
};
/// A character that was typed, by whatever keys.
struct TextEvent {
    char32_t character = 0;
};
struct ButtonEvent {
    int button = 0;  ///< GLFW_MOUSE_BUTTON_*
    int mods = 0;
    bool pressed = false;
    glm::dvec2 at{0.0};
};
struct MoveEvent {
    glm::dvec2 at{0.0};
};
struct ScrollEvent {
    double steps = 0.0;
    int mods = 0;
    glm::dvec2 at{0.0};
};
struct DropEvent {
    std::vector<std::string> paths;
};
/// The window's size changed, or its contents were lost.
struct DamageEvent {};
/// Positions are in pixels of the frame buffer.
struct InputEvent {
    std::variant<KeyEvent, TextEvent, ButtonEvent, MoveEvent, ScrollEvent, DropEvent, DamageEvent> what;
    double time_s = 0.0;         ///< when it was received
    double earliest_s = time_s;  ///< it happened no sooner: what comes while a long frame is drawn is received after it
};

class Swapchain;

class Window {
public:
    /// Fails if there is no display.
    Window(const std::string& title, const glm::uvec2& size);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Requirements for a device that presents to this window.
    gpu::DeviceOptions device_needs() const;
    void attach(gpu::Device& device, gpu::Memory& memory);
    void detach();

    bool should_close() const;
    void close();
    void stay_open();
    void set_title(const std::string& title);
    glm::uvec2 pixels() const;
    double content_scale() const;  ///< 2 on a HiDPI screen; another once the window is on another
    double now_s() const;
    /// Takes the whole of the screen that the window is on, or gives it back.
    void set_full_screen(bool is_full);

    /// Waits for events, at most that long (0: not at all), and returns them.
    std::vector<InputEvent> wait_events(double timeout_s);
    /// Lets the interface know a key or a character in its next frame: in the order of events, and no sooner than it is
    /// its turn.
    void tell_ui(const InputEvent& event);
    /// Whether a key is held down.
    bool is_down(int key) const;
    /// Whether the interface has not been told of all presses of buttons yet: each frame tells one.
    bool has_clicks() const;

    /// Layers must have blue first (View::Options).
    bool swaps_red_and_blue() const;

    /// Whether a frame can be drawn and shown without waiting. While the window is hidden that may not be for long:
    /// ask again a little later. Never waits.
    bool is_ready();
    void begin_ui();
    /// Uploads Dear ImGui's fonts anew, before the next frame. Waits for the device; rare.
    void renew_fonts();
    /// Draws the layers with their upper left corner at `origin`, the interface over them, and shows the frame. False
    /// if there is nothing to draw on (minimised, hidden), or if the frame was lost: draw it again.
    /// Where that will wait for the screen, `meanwhile` is called with for how long, once the frame is on its way to
    /// the device; it may be empty.
    bool present(const std::vector<View::Layer>& layers, const glm::uvec2& origin,
                 const std::function<void(double wait_ms)>& meanwhile);

    /// Frames submitted to the device, and those it has finished, which are visible. Never waits.
    uint64_t frames_presented() const;
    uint64_t frames_done() const;

private:
    struct Input;
    std::unique_ptr<Input> input_;
    std::unique_ptr<Swapchain> swapchain_;
};

}  // namespace shvr::ui
