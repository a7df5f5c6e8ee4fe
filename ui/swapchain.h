#pragma once
// The window's swapchain, and Dear ImGui's Vulkan back end: swapchain.cpp creates both, swapchain_frame.cpp draws with
// them. These are the only files outside engine/gpu that call Vulkan.
//
//   layers of the views -> copied into the swapchain's image -> the interface drawn over them -> presented
//
// Main thread only.

#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "engine/gpu/memory.h"
#include "engine/live/view.h"

struct GLFWwindow;

namespace shvr::ui {

class Swapchain {
public:
    /// Fails if the device cannot present to the window.
    Swapchain(gpu::Device& device, gpu::Memory& memory, GLFWwindow* window);
    ~Swapchain();
    /// Called once the frame is submitted, before a call that is expected to wait `wait_ms` milliseconds for the
    /// screen.
    using Meanwhile = std::function<void(double wait_ms)>;
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    /// Layers must have blue first (View::Options).
    bool swaps_red_and_blue() const { return format_.format == VK_FORMAT_B8G8R8A8_UNORM; }
    /// Uploads Dear ImGui's fonts again. Call between frames; waits for the device.
    void renew_fonts();
    /// Call before ImGui::NewFrame.
    static void begin_ui();
    /// Returns whether a frame can be drawn and shown without waiting, because an image is available. While the window
    /// is hidden, no image may be available for a long time. Does not wait, except some milliseconds for the first
    /// image of a new swapchain. Fails as present() does.
    bool is_ready();
    /// Implements Window::present; call after ImGui::Render. A failed frame leaves no state that breaks later frames. A
    /// lost surface is re-created, and the frame is not shown.
    bool present(const std::vector<View::Layer>& layers, const glm::uvec2& origin, const Meanwhile& meanwhile);

    uint64_t frames_presented() const { return presented_; }
    uint64_t frames_done() const;

private:
    static constexpr uint32_t FRAMES_IN_FLIGHT = 2;
    static constexpr uint32_t IMAGES = 3;  ///< number of images: one displayed, one queued, one being drawn
    struct Target {
        VkImage image = VK_NULL_HANDLE;
        VkImageView view = VK_NULL_HANDLE;
        VkFramebuffer framebuffer = VK_NULL_HANDLE;
        VkSemaphore drawn = VK_NULL_HANDLE;
        uint64_t presented = 0;  ///< number of the last frame presented in this image
    };
    struct Frame {
        VkCommandBuffer commands = VK_NULL_HANDLE;
        VkSemaphore acquired = VK_NULL_HANDLE;
        VkFence done = VK_NULL_HANDLE;
        uint64_t number = 0;      ///< number of the last frame recorded in this slot
        uint64_t submission = 0;  ///< submission number of that frame (gpu::Device)
        uint64_t follows = 0;     ///< number of the frame that the same image showed before
    };
    /// A swapchain that has been replaced by another one: the screen may still be reading from its images.
    struct Retired {
        VkSwapchainKHR swapchain = VK_NULL_HANDLE;
        std::vector<Target> targets;
        VkSemaphore acquired = VK_NULL_HANDLE;  ///< semaphore of an image that was acquired but not drawn
        uint64_t submission = 0;                ///< last submission that uses the swapchain
        uint64_t presented = 0;                 ///< number of the last frame presented through the swapchain
    };

    /// Thrown if the surface was lost and has to be re-created. Callers handle all other failures.
    class SurfaceLost : public Error {
    public:
        using Error::Error;
    };
    void check(VkResult result, const char* call) const;
    void create();
    void create_surface();
    void renew_surface();
    void choose_format();
    void create_render_pass();
    void create_frames();
    void complete(Frame& frame) const;
    void abandon(Frame& frame);
    bool prepare(Frame& frame);
    bool acquire(Frame& frame);
    bool surface_has_changed() const;
    bool show(Frame& frame, const std::vector<View::Layer>& layers, const glm::uvec2& origin,
              const Meanwhile& meanwhile);
    VkResult hand_to_screen(const VkPresentInfoKHR& info);
    double expected_wait_ms() const;
    template <class Try>
    bool attempt(const Try& attempted);
    void create_imgui();
    bool create_swapchain();
    VkSwapchainKHR retire();
    void free_retired();
    void add_target(VkImage image);
    void destroy(const Retired& retired) const;
    void destroy_swapchains();
    void destroy();
    void record(const Frame& frame, const Target& target, const std::vector<View::Layer>& layers,
                const glm::uvec2& origin) const;
    void draw_layers(VkCommandBuffer commands, VkImage target, const std::vector<View::Layer>& layers,
                     const glm::uvec2& origin) const;

    gpu::Device& device_;
    gpu::Memory& memory_;
    GLFWwindow* window_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSurfaceFormatKHR format_{};
    VkRenderPass render_pass_ = VK_NULL_HANDLE;
    VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkExtent2D extent_{};
    glm::ivec2 made_for_{0};              ///< window size in pixels
    VkSurfaceCapabilitiesKHR made_of_{};  ///< surface capabilities when the swapchain was created
    std::optional<uint32_t> acquired_;    ///< index of the image for the next frame
    uint32_t patient_acquisitions_ = 0;   ///< remaining acquisitions of a new swapchain that may block
    std::vector<Target> targets_;
    std::deque<Retired> retired_;  ///< the oldest first
    std::array<Frame, FRAMES_IN_FLIGHT> frames_;
    uint32_t next_frame_ = 0;
    VkPresentModeKHR mode_ = VK_PRESENT_MODE_FIFO_KHR;
    std::array<double, 3> waits_ms_{};  ///< times that the last frames waited for the screen
    uint64_t presented_ = 0;
    uint64_t taken_ = 0;            ///< number of the last frame known to have been taken from the queue by the screen
    uint64_t last_submission_ = 0;  ///< last submission of any frame
    bool is_stale_ = false;         ///< the swapchain must be re-created before the next frame
    bool imgui_is_ready_ = false;
    mutable int max_vertices_ = 0, max_indices_ = 0;  ///< maxima over all frames; Dear ImGui sizes its buffers by them
};

}  // namespace shvr::ui
