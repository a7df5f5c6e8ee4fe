#include "ui/window.h"

#include <algorithm>
#include <array>
#include <utility>

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui/imgui.h>

namespace shvr::ui {

namespace {

constexpr uint32_t FRAMES_IN_FLIGHT = 2;
constexpr VkClearColorValue BACKDROP{{0.09f, 0.09f, 0.10f, 1.0f}};

std::string glfw_error()
{
    const char* description = nullptr;
    glfwGetError(&description);
    return description ? description : "no reason given";
}

void image_barrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                   VkPipelineStageFlags2 after, VkAccessFlags2 written, VkPipelineStageFlags2 before,
                   VkAccessFlags2 touched)
{
    const VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                        .srcStageMask = after,
                                        .srcAccessMask = written,
                                        .dstStageMask = before,
                                        .dstAccessMask = touched,
                                        .oldLayout = from,
                                        .newLayout = to,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = image,
                                        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &info);
}

void memory_barrier(VkCommandBuffer commands, VkPipelineStageFlags2 after, VkAccessFlags2 written,
                    VkPipelineStageFlags2 before, VkAccessFlags2 touched)
{
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = after,
                                   .srcAccessMask = written,
                                   .dstStageMask = before,
                                   .dstAccessMask = touched};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &info);
}

VkOffset3D offset(const glm::ivec2& at)
{
    return {at.x, at.y, 0};
}

}  // namespace

/// GLFW's window and what the person did in it.
struct Window::Input {
    GLFWwindow* window = nullptr;
    std::vector<InputEvent> events;
    bool frame_is_open = false;  ///< of the interface: begun, and not yet rendered

    static Input& of(GLFWwindow* window) { return *static_cast<Input*>(glfwGetWindowUserPointer(window)); }
    template <class Event>
    static void add(GLFWwindow* window, Event event)
    {
        of(window).events.push_back({std::move(event), glfwGetTime()});
    }
    /// Where the mouse was when the event happened: GLFW itself tells where it is by now, which is too late where a turn of
    /// the loop takes in a whole gesture.
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
    /// Screen coordinates to pixels: they differ on some HiDPI systems.
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
    /// Before Dear ImGui installs its own callbacks, which call these.
    void listen() const
    {
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
            add(w, KeyEvent{key, mods, action != GLFW_RELEASE, action == GLFW_REPEAT});
        });
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
            add(w, ButtonEvent{button, mods, action == GLFW_PRESS, cursor(w)});
        });
        glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
            of(w).last_cursor = in_pixels(w, {x, y});
            add(w, MoveEvent{cursor(w)});
        });
        glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) {
            add(w, ScrollEvent{y, mods(w), cursor(w)});
        });
        glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
            add(w, DropEvent{{paths, paths + count}});
        });
        glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { add(w, DamageEvent{}); });
        glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { add(w, DamageEvent{}); });
        glfwSetCharCallback(window, [](GLFWwindow*, unsigned) {});
    }
};

/// Everything that needs the device.
struct Window::Vulkan {
    gpu::Device& device;
    gpu::Memory& memory;
    GLFWwindow* window;
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    VkSurfaceFormatKHR format{};
    VkRenderPass render_pass = VK_NULL_HANDLE;
    VkDescriptorPool descriptors = VK_NULL_HANDLE;
    VkCommandPool pool = VK_NULL_HANDLE;
    VkSwapchainKHR swapchain = VK_NULL_HANDLE;
    VkExtent2D extent{};
    struct Target {
        VkImage image = VK_NULL_HANDLE;
        VkImageView view = VK_NULL_HANDLE;
        VkFramebuffer framebuffer = VK_NULL_HANDLE;
        VkSemaphore drawn = VK_NULL_HANDLE;
    };
    std::vector<Target> targets;
    struct Frame {
        VkCommandBuffer commands = VK_NULL_HANDLE;
        VkSemaphore acquired = VK_NULL_HANDLE;
        VkFence done = VK_NULL_HANDLE;
        uint64_t number = 0;  ///< of the frame it was used for last
    };
    std::array<Frame, FRAMES_IN_FLIGHT> frames;
    uint32_t next_frame = 0;
    uint64_t presented = 0;
    bool imgui_is_ready = false;

    Vulkan(gpu::Device& owner, gpu::Memory& book, GLFWwindow* glfw) : device(owner), memory(book), window(glfw)
    {
        try {
            create();
        } catch (...) {
            destroy();
            throw;
        }
    }
    ~Vulkan() { destroy(); }
    Vulkan(const Vulkan&) = delete;
    Vulkan& operator=(const Vulkan&) = delete;

    void create();
    void choose_format();
    void create_render_pass();
    void create_frames();
    void create_imgui();
    void create_swapchain();
    void destroy_targets();
    void destroy();
    void record(const Frame& frame, const Target& target, const std::vector<View::Layer>& layers,
                const glm::uvec2& origin) const;
    void draw_layers(VkCommandBuffer commands, VkImage target, const std::vector<View::Layer>& layers,
                     const glm::uvec2& origin) const;
    bool present(const std::vector<View::Layer>& layers, const glm::uvec2& origin);
};

void Window::Vulkan::create()
{
    SHVR_VK(glfwCreateWindowSurface(device.instance(), window, nullptr, &surface));
    VkBool32 presents = VK_FALSE;
    SHVR_VK(vkGetPhysicalDeviceSurfaceSupportKHR(device.physical(), device.queue_family(), surface, &presents));
    if (!presents)
        fail("device ", device.traits().name, " cannot show pictures in this window; --device chooses another");
    choose_format();
    create_render_pass();
    create_frames();
    create_swapchain();
    create_imgui();
}

void Window::Vulkan::choose_format()
{
    const auto formats = gpu::enumerate<VkSurfaceFormatKHR>([&](uint32_t* count, VkSurfaceFormatKHR* items) {
        vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, count, items);
    });
    // What is shown is encoded already, so the image must not encode again; and it is copied byte by byte.
    for (const VkSurfaceFormatKHR& candidate : formats)
        if (candidate.format == VK_FORMAT_B8G8R8A8_UNORM || candidate.format == VK_FORMAT_R8G8B8A8_UNORM) {
            format = candidate;
            return;
        }
    fail("the window's surface has no format of 8 bits a channel; expected B8G8R8A8_UNORM or R8G8B8A8_UNORM");
}

void Window::Vulkan::create_render_pass()
{
    const VkAttachmentDescription attachment{.format = format.format,
                                             .samples = VK_SAMPLE_COUNT_1_BIT,
                                             .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                             .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                             .initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                             .finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR};
    const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass{.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                       .colorAttachmentCount = 1,
                                       .pColorAttachments = &reference};
    const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                      .attachmentCount = 1,
                                      .pAttachments = &attachment,
                                      .subpassCount = 1,
                                      .pSubpasses = &subpass};
    SHVR_VK(vkCreateRenderPass(device.handle(), &info, nullptr, &render_pass));
    device.set_name(VK_OBJECT_TYPE_RENDER_PASS, reinterpret_cast<uint64_t>(render_pass), "user interface");
}

void Window::Vulkan::create_frames()
{
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                            .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                            .queueFamilyIndex = device.queue_family()};
    SHVR_VK(vkCreateCommandPool(device.handle(), &pool_info, nullptr, &pool));
    device.set_name(VK_OBJECT_TYPE_COMMAND_POOL, reinterpret_cast<uint64_t>(pool), "window");
    for (Frame& frame : frames) {
        const VkCommandBufferAllocateInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                   .commandPool = pool,
                                                   .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                   .commandBufferCount = 1};
        SHVR_VK(vkAllocateCommandBuffers(device.handle(), &commands, &frame.commands));
        const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        SHVR_VK(vkCreateSemaphore(device.handle(), &semaphore, nullptr, &frame.acquired));
        const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                      .flags = VK_FENCE_CREATE_SIGNALED_BIT};
        SHVR_VK(vkCreateFence(device.handle(), &fence, nullptr, &frame.done));
    }
}

void Window::Vulkan::create_imgui()
{
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 8};
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
                                          .maxSets = 8,
                                          .poolSizeCount = 1,
                                          .pPoolSizes = &size};
    SHVR_VK(vkCreateDescriptorPool(device.handle(), &info, nullptr, &descriptors));
    ImGui_ImplVulkan_InitInfo init{};
    init.Instance = device.instance();
    init.PhysicalDevice = device.physical();
    init.Device = device.handle();
    init.QueueFamily = device.queue_family();
    init.Queue = device.queue();
    init.DescriptorPool = descriptors;
    init.MinImageCount = 2;
    init.ImageCount = uint32_t(std::max<size_t>(targets.size(), FRAMES_IN_FLIGHT));
    init.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    init.CheckVkResultFn = [](VkResult result) { gpu::check(result, "Dear ImGui"); };
    ImGui_ImplVulkan_Init(&init, render_pass);
    imgui_is_ready = true;

    const VkCommandBuffer commands = frames[0].commands;
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    SHVR_VK(vkBeginCommandBuffer(commands, &begin));
    ImGui_ImplVulkan_CreateFontsTexture(commands);
    SHVR_VK(vkEndCommandBuffer(commands));
    const VkCommandBufferSubmitInfo submitted{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                              .commandBuffer = commands};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &submitted};
    SHVR_VK(vkQueueSubmit2(device.queue(), 1, &submit, VK_NULL_HANDLE));
    device.wait_idle();
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Window::Vulkan::create_swapchain()
{
    device.wait_idle();
    destroy_targets();
    VkSurfaceCapabilitiesKHR capabilities;
    SHVR_VK(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical(), surface, &capabilities));
    extent = capabilities.currentExtent;
    if (extent.width == ~0u) {  // the surface takes what it is given
        glm::ivec2 size(0);
        glfwGetFramebufferSize(window, &size.x, &size.y);
        extent = {uint32_t(size.x), uint32_t(size.y)};
    }
    if (extent.width == 0 || extent.height == 0) return;  // minimised
    uint32_t images = std::max(capabilities.minImageCount, FRAMES_IN_FLIGHT);
    if (capabilities.maxImageCount > 0) images = std::min(images, capabilities.maxImageCount);
    const VkSwapchainKHR old = swapchain;
    const VkSwapchainCreateInfoKHR info{
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = surface,
        .minImageCount = images,
        .imageFormat = format.format,
        .imageColorSpace = format.colorSpace,
        .imageExtent = extent,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .preTransform = capabilities.currentTransform,
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
        .clipped = VK_TRUE,
        .oldSwapchain = old};
    swapchain = VK_NULL_HANDLE;
    const VkResult result = vkCreateSwapchainKHR(device.handle(), &info, nullptr, &swapchain);
    if (old) vkDestroySwapchainKHR(device.handle(), old, nullptr);
    gpu::check(result, "vkCreateSwapchainKHR");

    const auto chain = gpu::enumerate<VkImage>(
        [&](uint32_t* count, VkImage* items) { vkGetSwapchainImagesKHR(device.handle(), swapchain, count, items); });
    for (VkImage image : chain) {
        Target& target = targets.emplace_back();
        target.image = image;
        device.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image), "swapchain");
        const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                         .image = image,
                                         .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                         .format = format.format,
                                         .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
        SHVR_VK(vkCreateImageView(device.handle(), &view, nullptr, &target.view));
        const VkFramebufferCreateInfo framebuffer{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                  .renderPass = render_pass,
                                                  .attachmentCount = 1,
                                                  .pAttachments = &target.view,
                                                  .width = extent.width,
                                                  .height = extent.height,
                                                  .layers = 1};
        SHVR_VK(vkCreateFramebuffer(device.handle(), &framebuffer, nullptr, &target.framebuffer));
        const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        SHVR_VK(vkCreateSemaphore(device.handle(), &semaphore, nullptr, &target.drawn));
    }
}

void Window::Vulkan::destroy_targets()
{
    for (const Target& target : targets) {
        vkDestroySemaphore(device.handle(), target.drawn, nullptr);
        vkDestroyFramebuffer(device.handle(), target.framebuffer, nullptr);
        vkDestroyImageView(device.handle(), target.view, nullptr);
    }
    targets.clear();
}

void Window::Vulkan::destroy()
{
    vkDeviceWaitIdle(device.handle());
    if (imgui_is_ready) ImGui_ImplVulkan_Shutdown();
    destroy_targets();
    vkDestroySwapchainKHR(device.handle(), swapchain, nullptr);
    for (const Frame& frame : frames) {
        vkDestroyFence(device.handle(), frame.done, nullptr);
        vkDestroySemaphore(device.handle(), frame.acquired, nullptr);
    }
    vkDestroyCommandPool(device.handle(), pool, nullptr);
    vkDestroyDescriptorPool(device.handle(), descriptors, nullptr);
    vkDestroyRenderPass(device.handle(), render_pass, nullptr);
    vkDestroySurfaceKHR(device.instance(), surface, nullptr);
}

void Window::Vulkan::draw_layers(VkCommandBuffer commands, VkImage target, const std::vector<View::Layer>& layers,
                                 const glm::uvec2& origin) const
{
    const glm::ivec2 window_size(extent.width, extent.height);
    const VkImageSubresourceLayers color{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    for (size_t first = 0; first < layers.size();) {
        const VkImage source = memory.object(layers[first].image.id).image;
        std::vector<VkImageCopy> regions;
        size_t last = first;
        for (; last < layers.size() && layers[last].image.id == layers[first].image.id; ++last) {
            const View::Layer& layer = layers[last];
            const glm::ivec2 begin(layer.target.begin + origin);
            const glm::uvec2 size = layer.target.end - layer.target.begin;
            // The window may have shrunk since the layers were drawn.
            if (glm::any(glm::greaterThan(begin + glm::ivec2(size), window_size))) continue;
            regions.push_back({.srcSubresource = color,
                               .srcOffset = offset(layer.source.begin),
                               .dstSubresource = color,
                               .dstOffset = offset(begin),
                               .extent = {size.x, size.y, 1}});
        }
        if (!regions.empty()) {
            if (first > 0)  // over what is there
                memory_barrier(commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                               VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
            // A copy, not a blit: on a software device a blit of the whole view takes longer than all of the interface.
            vkCmdCopyImage(commands, source, VK_IMAGE_LAYOUT_GENERAL, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                           uint32_t(regions.size()), regions.data());
        }
        first = last;
    }
}

void Window::Vulkan::record(const Frame& frame, const Target& target, const std::vector<View::Layer>& layers,
                            const glm::uvec2& origin) const
{
    constexpr VkPipelineStageFlags2 TRANSFER = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    constexpr VkPipelineStageFlags2 WORK = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | TRANSFER;
    const VkCommandBuffer commands = frame.commands;
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    SHVR_VK(vkBeginCommandBuffer(commands, &begin));
    device.begin_label(commands, "window");
    image_barrier(commands, target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, TRANSFER, 0,
                  TRANSFER, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &BACKDROP, 1, &whole);
    // What the view's frames wrote, and the clearing, before the layers are copied.
    memory_barrier(commands, WORK, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT, TRANSFER,
                   VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    draw_layers(commands, target.image, layers, origin);
    // The view's next frames may write what was copied only after that: their graphs do not know of this reader.
    memory_barrier(commands, TRANSFER, 0, WORK, 0);
    image_barrier(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, TRANSFER, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                  VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    const VkRenderPassBeginInfo pass{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                     .renderPass = render_pass,
                                     .framebuffer = target.framebuffer,
                                     .renderArea = {{0, 0}, extent}};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
    vkCmdEndRenderPass(commands);
    device.end_label(commands);
    SHVR_VK(vkEndCommandBuffer(commands));
}

bool Window::Vulkan::present(const std::vector<View::Layer>& layers, const glm::uvec2& origin)
{
    glm::ivec2 size(0);
    glfwGetFramebufferSize(window, &size.x, &size.y);
    if (size.x <= 0 || size.y <= 0) return false;
    if (!swapchain || extent.width != uint32_t(size.x) || extent.height != uint32_t(size.y)) create_swapchain();
    if (targets.empty()) return false;

    Frame& frame = frames[next_frame];
    SHVR_VK(vkWaitForFences(device.handle(), 1, &frame.done, VK_TRUE, UINT64_MAX));
    uint32_t index = 0;
    VkResult acquired =
        vkAcquireNextImageKHR(device.handle(), swapchain, UINT64_MAX, frame.acquired, VK_NULL_HANDLE, &index);
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
        create_swapchain();
        return false;
    }
    gpu::check(acquired, "vkAcquireNextImageKHR");
    SHVR_VK(vkResetFences(device.handle(), 1, &frame.done));
    record(frame, targets[index], layers, origin);

    const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                             .commandBuffer = frame.commands};
    const VkSemaphoreSubmitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                     .semaphore = frame.acquired,
                                     .stageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = targets[index].drawn,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .waitSemaphoreInfoCount = 1,
                               .pWaitSemaphoreInfos = &wait,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &commands,
                               .signalSemaphoreInfoCount = 1,
                               .pSignalSemaphoreInfos = &signal};
    SHVR_VK(vkQueueSubmit2(device.queue(), 1, &submit, frame.done));
    frame.number = ++presented;
    next_frame = (next_frame + 1) % FRAMES_IN_FLIGHT;
    const VkPresentInfoKHR present_info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                        .waitSemaphoreCount = 1,
                                        .pWaitSemaphores = &targets[index].drawn,
                                        .swapchainCount = 1,
                                        .pSwapchains = &swapchain,
                                        .pImageIndices = &index};
    const VkResult shown = vkQueuePresentKHR(device.queue(), &present_info);
    if (shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR)
        create_swapchain();
    else
        gpu::check(shown, "vkQueuePresentKHR");
    return true;
}

Window::Window(const std::string& title, const glm::uvec2& size) : input_(std::make_unique<Input>())
{
    if (!glfwInit()) fail("no window can be opened (", glfw_error(), "); expected a display, as in DISPLAY=:0");
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
    ImGui::GetIO().IniFilename = nullptr;  // no file is left behind in the working directory
    ImGui_ImplGlfw_InitForVulkan(input_->window, true);
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
    if (!names) fail("Vulkan cannot show pictures on this display (", glfw_error(), ")");
    options.instance_extensions.assign(names, names + count);
    return options;
}

void Window::attach(gpu::Device& device, gpu::Memory& memory)
{
    vulkan_.reset();
    vulkan_ = std::make_unique<Vulkan>(device, memory, input_->window);
}

void Window::detach()
{
    vulkan_.reset();
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

double Window::now_s() const
{
    return glfwGetTime();
}

std::vector<InputEvent> Window::wait_events(double timeout_s)
{
    if (timeout_s > 0.0)
        glfwWaitEventsTimeout(timeout_s);
    else
        glfwPollEvents();
    return std::exchange(input_->events, {});
}

bool Window::is_down(int key) const
{
    return glfwGetKey(input_->window, key) == GLFW_PRESS;
}

void Window::begin_ui()
{
    if (std::exchange(input_->frame_is_open, true)) ImGui::EndFrame();  // the last one failed before it was shown
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

bool Window::present(const std::vector<View::Layer>& layers, const glm::uvec2& origin)
{
    ImGui::Render();
    input_->frame_is_open = false;
    return vulkan_->present(layers, origin);
}

bool Window::swaps_red_and_blue() const
{
    return vulkan_->format.format == VK_FORMAT_B8G8R8A8_UNORM;
}

uint64_t Window::frames_presented() const
{
    return vulkan_->presented;
}

uint64_t Window::frames_done() const
{
    uint64_t done = 0;
    uint64_t running = vulkan_->presented + 1;
    for (const Vulkan::Frame& frame : vulkan_->frames)
        if (vkGetFenceStatus(vulkan_->device.handle(), frame.done) == VK_SUCCESS)
            done = std::max(done, frame.number);
        else
            running = std::min(running, frame.number);
    return std::min(done, running - 1);
}

}  // namespace shvr::ui
