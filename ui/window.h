#pragma once
// The window, by GLFW: it shows images of the view under the user interface (swapchain.h), and collects what the person
// did.
//
//     Window window({...});                                  // before the device, which must know what it needs
//     Renderer renderer({.device = window.device_needs()});
//     window.attach(renderer.device(), renderer.memory());
//     while (!window.should_close()) {
//         for (const InputEvent& event : window.wait_events(0.01)) ...
//         window.begin_ui(); ... ImGui calls ...; window.present(layers, origin);
//     }
//     window.detach();                                       // before the device goes
//
// The main thread.

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
/// The window's size changed, or what it shows was lost.
struct DamageEvent {};
/// Positions are pixels of the frame buffer.
struct InputEvent {
    std::variant<KeyEvent, ButtonEvent, MoveEvent, ScrollEvent, DropEvent, DamageEvent> what;
    double time_s = 0.0;  ///< when it was received
};

class Swapchain;

class Window {
public:
    /// Fails where there is no display.
    Window(const std::string& title, const glm::uvec2& size);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// What a device that is to draw here must have.
    gpu::DeviceOptions device_needs() const;
    void attach(gpu::Device& device, gpu::Memory& memory);
    void detach();

    bool should_close() const;
    void close();
    void stay_open();
    void set_title(const std::string& title);
    glm::uvec2 pixels() const;
    double content_scale() const;  ///< 2 on a HiDPI screen
    double now_s() const;

    /// Waits for events, at most so long (0: not at all), and gives those that came.
    std::vector<InputEvent> wait_events(double timeout_s);
    /// Whether a key is held down.
    bool is_down(int key) const;

    /// Layers must have blue first (View::Options).
    bool swaps_red_and_blue() const;

    void begin_ui();
    /// Draws the layers with their upper left corner at `origin`, the interface over them, and shows the frame. False
    /// where there is nothing to draw on (minimised).
    bool present(const std::vector<View::Layer>& layers, const glm::uvec2& origin);

    /// Frames that were handed to the device, and those it is done with: they can be seen. Never waits.
    uint64_t frames_presented() const;
    uint64_t frames_done() const;

private:
    struct Input;
    std::unique_ptr<Input> input_;
    std::unique_ptr<Swapchain> swapchain_;
};

}  // namespace shvr::ui
