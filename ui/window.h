#pragma once
// The window, through GLFW: shows images of the view under the user interface (swapchain.h) and collects input.
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
// Main thread only.

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
    std::string character{};  ///< the key's character in the user's layout, without modifiers; empty: none, or unknown
};
/// A typed character, whatever its keys.
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
    int mods = 0;
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
    double time_s = 0.0;         ///< time of receipt
    double earliest_s = time_s;  ///< earliest time of the event, since a long frame delays input
};

class Swapchain;

class Window {
public:
    /// Fails if there is no display.
    Window(const std::string& title, const glm::uvec2& size);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Returns what a device needs in order to present to this window.
    gpu::DeviceOptions device_needs() const;
    void attach(gpu::Device& device, gpu::Memory& memory);
    void detach();

    bool should_close() const;
    void close();
    void stay_open();
    void set_title(const std::string& title);
    glm::uvec2 pixels() const;
    double content_scale() const;  ///< 2 on a HiDPI screen; changes when the window moves to another screen
    double now_s() const;
    /// Position and size on the screen, in its units. Some window systems tell and take no position.
    struct Place {
        glm::ivec2 at{0}, size{0};
        bool operator==(const Place&) const = default;
    };
    /// Returns the place of the window or, while it covers the whole screen, the place that it had before.
    Place place() const;
    /// Puts the window there if its title bar would be within a screen; otherwise only sets its size.
    void put(const Place& place);
    /// Covers the whole screen that shows the window, or restores the window.
    void set_full_screen(bool is_full);

    /// Waits for events, at most `timeout_s` (0: not at all), and returns them.
    std::vector<InputEvent> wait_events(double timeout_s);
    /// Passes a key or a character to the interface in one
    /// of its next frames. The order of events is preserved.
    void tell_ui(const InputEvent& event);
    /// Returns whether a key is held down.
    bool is_down(int key) const;
    /// Returns whether the interface's last frame received a press of the key, so that it saw the key down.
    bool was_just_pressed(int key) const;
    /// Returns whether button presses are still queued for the interface, which gets one press per frame.
    bool has_clicks() const;

    /// Layers must have blue first (View::Options).
    bool swaps_red_and_blue() const;

    /// Returns whether a frame can be drawn and shown without waiting. May stay false while the window is hidden: then
    /// call again a little later. Never waits.
    bool is_ready();
    void begin_ui();
    /// Uploads Dear ImGui's fonts again, before the next frame. Slow, since it waits for the device; rarely needed.
    void renew_fonts();
    /// Draws the layers with their upper left corner at `origin`, then the interface over them, and shows the frame.
    /// Returns false if no image is available to draw on (minimised, hidden), or if the frame was lost and must be
    /// drawn again. Calls `meanwhile`, unless it is empty, with the expected wait for the screen: after the frame is
    /// submitted to the device, and before the wait begins.
    bool present(const std::vector<View::Layer>& layers, const glm::uvec2& origin,
                 const std::function<void(double wait_ms)>& meanwhile);

    /// Return the number of frames submitted to the device, and of frames finished and shown. Neither function waits.
    uint64_t frames_presented() const;
    uint64_t frames_done() const;

private:
    struct Input;
    std::unique_ptr<Input> input_;
    std::unique_ptr<Swapchain> swapchain_;
};

}  // namespace shvr::ui
