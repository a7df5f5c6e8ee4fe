#include "ui/window.h"

#include <algorithm>
#include <utility>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <imgui/imgui.h>

#include "engine/gpu/live_trace.h"
#include "ui/display_report.h"
#include "ui/imgui_versions.h"
#include "ui/mouse_feed.h"
#include "ui/panels/font_files.h"
#include "ui/swapchain.h"

namespace shvr::ui {

namespace {

std::string glfw_error()
{
    const char* description = nullptr;
    glfwGetError(&description);
    return description ? description : "no reason given";
}

/// GLFW 3.4 prefers Wayland. There a window does not know its position or screen, and only the compositor can move the
/// pointer, which tests need to do. With X11 (Xwayland on Wayland), all GLFW versions behave alike.
bool start_glfw()
{
#ifdef GLFW_PLATFORM  // since 3.4
    glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
    if (glfwInit()) return true;
    glfwInitHint(GLFW_PLATFORM, GLFW_ANY_PLATFORM);
#endif
    return glfwInit() == GLFW_TRUE;
}

/// Returns the screen that contains this point or, if there is none, the primary screen.
GLFWmonitor* monitor_of(const glm::ivec2& point)
{
    int count = 0;
    GLFWmonitor** const monitors = glfwGetMonitors(&count);
    for (int i = 0; i < count; ++i) {
        glm::ivec2 at(0);
        glfwGetMonitorPos(monitors[i], &at.x, &at.y);
        const GLFWvidmode* const mode = glfwGetVideoMode(monitors[i]);
        if (mode && point.x >= at.x && point.y >= at.y && point.x < at.x + mode->width && point.y < at.y + mode->height)
            return monitors[i];
    }
    return glfwGetPrimaryMonitor();
}

}  // namespace

/// GLFW's window and the input received in it.
struct Window::Input {
    GLFWwindow* window = nullptr;
    std::vector<InputEvent> events;
    glm::ivec2 place{0}, size{0};  ///< position and size of the window before it became full screen
    FrameKeys keys;                ///< for the next frame of the interface
    FrameKeys last_keys;           ///< keys of its last frame
    MouseFeed mouse;
    double asked_s = 0.0, answered_s = 0.0;  ///< when the last wait for events began and ended

    /// Returns the earliest possible time of an event, since GLFW reports none: an event available at once may be old.
    double earliest_s() const
    {
        constexpr double AT_ONCE_S = 0.005;
        const double now = glfwGetTime();
        return now - asked_s < AT_ONCE_S ? answered_s : now;
    }
    bool frame_is_open = false;  ///< an interface frame was begun, and is not rendered yet

    static Input& of(GLFWwindow* window) { return *static_cast<Input*>(glfwGetWindowUserPointer(window)); }
    template <class Event>
    static void add(GLFWwindow* window, Event event)
    {
        of(window).events.push_back({std::move(event), glfwGetTime(), of(window).earliest_s()});
    }
    /// The mouse position at the time of the present event. GLFW reports only the current position, which is too late
    /// if an iteration of the loop receives a whole gesture.
    std::optional<glm::dvec2> last_cursor;
    static glm::dvec2 cursor(GLFWwindow* window)
    {
        std::optional<glm::dvec2>& last = of(window).last_cursor;
        if (!last) {
            glm::dvec2 at(0.0);
            glfwGetCursorPos(window, &at.x, &at.y);
            last = in_pixels(window, at);
        }
        return *last;
    }
    /// Converts screen coordinates to pixels, which differ on some HiDPI systems.
    static glm::dvec2 in_pixels(GLFWwindow* window, const glm::dvec2& at)
    {
        glm::ivec2 size(1), pixels(1);
        glfwGetWindowSize(window, &size.x, &size.y);
        glfwGetFramebufferSize(window, &pixels.x, &pixels.y);
        return at * glm::dvec2(pixels) / glm::dvec2(glm::max(size, glm::ivec2(1)));
    }
    static int mods(GLFWwindow* window)
    {
        const auto down = [&](int a, int b) {
            return glfwGetKey(window, a) == GLFW_PRESS || glfwGetKey(window, b) == GLFW_PRESS;
        };
        return (down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL) ? GLFW_MOD_CONTROL : 0) |
               (down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT) ? GLFW_MOD_SHIFT : 0) |
               (down(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT) ? GLFW_MOD_ALT : 0);
    }
    /// Call after Dear ImGui has installed its callbacks, which are replaced; Window::tell_ui passes events on to it.
    void listen_to_keys() const
    {
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scancode, int action, int mods) {
            const char* const character = glfwGetKeyName(key, scancode);
            add(w, KeyEvent{key, mods, action != GLFW_RELEASE, action == GLFW_REPEAT, character ? character : ""});
        });
        glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) { add(w, TextEvent{character}); });
    }
    /// Call before, since those call these.
    void listen() const
    {
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
            of(w).mouse.add(button, action == GLFW_PRESS, cursor(w), of(w).earliest_s(), glfwGetTime());
            add(w, ButtonEvent{button, mods, action == GLFW_PRESS, cursor(w)});
        });
        glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
            of(w).last_cursor = in_pixels(w, {x, y});
            add(w, MoveEvent{cursor(w), mods(w)});
        });
        glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) {
            add(w, ScrollEvent{y, mods(w), cursor(w)});
        });
        glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
            add(w, DropEvent{{paths, paths + count}});
        });
        glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { add(w, DamageEvent{}); });
        glfwSetWindowContentScaleCallback(window, [](GLFWwindow* w, float, float) { add(w, DamageEvent{}); });
        glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { add(w, DamageEvent{}); });
    }
};

DisplayReport survey_display()
{
    DisplayReport report{.font = interface_font()};
    if (!start_glfw()) {
        report.why_no_window = glfw_error();
        return report;
    }
    if (!glfwVulkanSupported()) report.why_no_window = "Vulkan cannot show pictures on this display";
    int count = 0;
    GLFWmonitor** const monitors = glfwGetMonitors(&count);
    for (int i = 0; i < count; ++i)
        if (const GLFWvidmode* const mode = glfwGetVideoMode(monitors[i]))
            report.screens.push_back(
                sentence(glfwGetMonitorName(monitors[i]), ", ", mode->width, " x ", mode->height, " pixels"));
    glfwTerminate();
    return report;
}

Window::Window(const std::string& title, const glm::uvec2& size) : input_(std::make_unique<Input>())
{
    if (!start_glfw()) fail("no window can be opened (", glfw_error(), "); expected a display, as in DISPLAY=:0");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    input_->window = glfwCreateWindow(int(size.x), int(size.y), title.c_str(), nullptr, nullptr);
    if (!input_->window) {
        const std::string reason = glfw_error();
        glfwTerminate();
        fail("no window can be opened (", reason, ")");
    }
    glfwSetWindowUserPointer(input_->window, input_.get());
    input_->listen();
    ImGui::CreateContext();
    set_up_imgui_input();
    ImGui::GetIO().IniFilename = nullptr;  // no settings file in the working directory
    ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    ImGui_ImplGlfw_InitForVulkan(input_->window, true);
    input_->listen_to_keys();
    paste_in_one_line();
}

Window::~Window()
{
    detach();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(input_->window);
    glfwTerminate();
}

gpu::DeviceOptions Window::device_needs() const
{
    gpu::DeviceOptions options;
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (!names)
        fail("Vulkan cannot show pictures on this display (", glfw_error(),
             "); expected a GPU driver, or the package mesa-vulkan-drivers (lavapipe)");
    options.instance_extensions.assign(names, names + count);
    options.can_present = [](VkInstance instance, VkPhysicalDevice physical, uint32_t family) {
        return glfwGetPhysicalDevicePresentationSupport(instance, physical, family) == GLFW_TRUE;
    };
    return options;
}

void Window::attach(gpu::Device& device, gpu::Memory& memory)
{
    swapchain_.reset();
    swapchain_ = std::make_unique<Swapchain>(device, memory, input_->window);
}

void Window::detach()
{
    swapchain_.reset();
}

bool Window::should_close() const
{
    return glfwWindowShouldClose(input_->window);
}

void Window::close()
{
    glfwSetWindowShouldClose(input_->window, GLFW_TRUE);
}

void Window::stay_open()
{
    glfwSetWindowShouldClose(input_->window, GLFW_FALSE);
}

void Window::set_title(const std::string& title)
{
    glfwSetWindowTitle(input_->window, title.c_str());
}

glm::uvec2 Window::pixels() const
{
    glm::ivec2 size(0);
    glfwGetFramebufferSize(input_->window, &size.x, &size.y);
    return glm::uvec2(glm::max(size, glm::ivec2(0)));
}

double Window::content_scale() const
{
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(input_->window, &x, &y);
    return double(x);
}

Window::Place Window::place() const
{
    if (glfwGetWindowMonitor(input_->window)) return {input_->place, input_->size};
    Place place;
    glfwGetWindowPos(input_->window, &place.at.x, &place.at.y);
    glfwGetWindowSize(input_->window, &place.size.x, &place.size.y);
    return place;
}

void Window::put(const Place& place)
{
    int count = 0;
    GLFWmonitor** const monitors = glfwGetMonitors(&count);
    const glm::ivec2 handle = place.at + glm::ivec2(place.size.x / 2, 1);  // what a person drags
    for (int i = 0; i < count; ++i) {
        glm::ivec2 at(0), size(0);
        glfwGetMonitorWorkarea(monitors[i], &at.x, &at.y, &size.x, &size.y);
        if (glm::any(glm::lessThan(handle, at)) || glm::any(glm::greaterThanEqual(handle, at + size))) continue;
        const glm::ivec2 fitting = glm::min(place.size, size);
        glfwSetWindowSize(input_->window, fitting.x, fitting.y);
        return glfwSetWindowPos(input_->window, place.at.x, place.at.y);
    }
    glfwSetWindowSize(input_->window, place.size.x, place.size.y);
}

void Window::set_full_screen(bool is_full)
{
    GLFWwindow* const window = input_->window;
    if (is_full == (glfwGetWindowMonitor(window) != nullptr)) return;
    glm::ivec2 &at = input_->place, &size = input_->size;
    if (!is_full) return glfwSetWindowMonitor(window, nullptr, at.x, at.y, size.x, size.y, GLFW_DONT_CARE);
    glfwGetWindowPos(window, &at.x, &at.y);
    glfwGetWindowSize(window, &size.x, &size.y);
    GLFWmonitor* const monitor = monitor_of(at + size / 2);
    const GLFWvidmode* const mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    if (!mode) fail("there is no screen to fill; expected one");
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

double Window::now_s() const
{
    return glfwGetTime();
}

std::vector<InputEvent> Window::wait_events(double timeout_s)
{
    input_->asked_s = glfwGetTime();
    if (timeout_s > 0.0)
        glfwWaitEventsTimeout(timeout_s);
    else
        glfwPollEvents();
    input_->answered_s = glfwGetTime();
    return std::exchange(input_->events, {});
}

void Window::tell_ui(const InputEvent& event)
{
    if (const auto* text = std::get_if<TextEvent>(&event.what)) tell_imgui_character(input_->window, text->character);
    const auto* const key = std::get_if<KeyEvent>(&event.what);
    if (!key || key->repeated || key->key < 0) return;
    input_->keys.add(key->key, key->pressed);
    tell_imgui_key(input_->window, key->key, key->pressed, key->mods);
}

bool Window::is_down(int key) const
{
    return glfwGetKey(input_->window, key) == GLFW_PRESS;
}

void Window::renew_fonts()
{
    if (std::exchange(input_->frame_is_open, false)) ImGui::EndFrame();
    if (swapchain_) swapchain_->renew_fonts();
}

bool Window::was_just_pressed(int key) const
{
    return std::ranges::find(input_->last_keys.pressed, key) != input_->last_keys.pressed.end();
}

bool Window::has_clicks() const
{
    return input_->mouse.is_waiting();
}

bool Window::is_ready()
{
    return swapchain_->is_ready();
}

void Window::begin_ui()
{
    if (std::exchange(input_->frame_is_open, true)) ImGui::EndFrame();  // the last frame failed before it was presented
    Swapchain::begin_ui();
    ImGui_ImplGlfw_NewFrame();
    tell_imgui_buttons(input_->window, input_->mouse.next());  // one button change per frame, at its own position
    // A key that was pressed and released during the last frame, which may have been long, still counts as pressed.
    input_->last_keys = std::exchange(input_->keys, {});
    begin_imgui_frame(input_->window, input_->last_keys, Input::mods(input_->window));
}

bool Window::present(const std::vector<View::Layer>& layers, const glm::uvec2& origin,
                     const std::function<void(double wait_ms)>& meanwhile)
{
    ImGui::Render();
    input_->frame_is_open = false;
    const bool is_shown = swapchain_->present(layers, origin, meanwhile);
    gpu::trace_frame();
    return is_shown;
}

bool Window::swaps_red_and_blue() const
{
    return swapchain_->swaps_red_and_blue();
}

uint64_t Window::frames_presented() const
{
    return swapchain_->frames_presented();
}

uint64_t Window::frames_done() const
{
    return swapchain_->frames_done();
}

}  // namespace shvr::ui
