#include "ui/swapchain.h"

#include <algorithm>
#include <utility>

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui/imgui.h>

namespace shvr::ui {

namespace {

constexpr VkClearColorValue BACKDROP{{0.09f, 0.09f, 0.10f, 1.0f}};

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

Swapchain::Swapchain(gpu::Device& device, gpu::Memory& memory, GLFWwindow* window)
    : device_(device), memory_(memory), window_(window)
{
    try {
        create();
    } catch (...) {
        destroy();
        throw;
    }
}

Swapchain::~Swapchain()
{
    destroy();
}

void Swapchain::begin_ui()
{
    ImGui_ImplVulkan_NewFrame();
}

void Swapchain::create()
{
    SHVR_VK(glfwCreateWindowSurface(device_.instance(), window_, nullptr, &surface_));
    VkBool32 presents = VK_FALSE;
    SHVR_VK(vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical(), device_.queue_family(), surface_, &presents));
    if (!presents)
        fail("device ", device_.traits().name, " cannot show pictures in this window_; --device chooses another");
    choose_format();
    create_render_pass();
    create_frames();
    create_swapchain();
    create_imgui();
}

void Swapchain::choose_format()
{
    const auto formats = gpu::enumerate<VkSurfaceFormatKHR>([&](uint32_t* count, VkSurfaceFormatKHR* items) {
        vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, count, items);
    });
    // The layers are already encoded and are copied byte by byte, so the image must not encode again.
    for (const VkSurfaceFormatKHR& candidate : formats)
        if (candidate.format == VK_FORMAT_B8G8R8A8_UNORM || candidate.format == VK_FORMAT_R8G8B8A8_UNORM) {
            format_ = candidate;
            return;
        }
    fail("the window's surface has no format of 8 bits a channel; expected B8G8R8A8_UNORM or R8G8B8A8_UNORM");
}

void Swapchain::create_render_pass()
{
    const VkAttachmentDescription attachment{.format = format_.format,
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
    SHVR_VK(vkCreateRenderPass(device_.handle(), &info, nullptr, &render_pass_));
    device_.set_name(VK_OBJECT_TYPE_RENDER_PASS, reinterpret_cast<uint64_t>(render_pass_), "user interface");
}

void Swapchain::create_frames()
{
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                            .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                            .queueFamilyIndex = device_.queue_family()};
    SHVR_VK(vkCreateCommandPool(device_.handle(), &pool_info, nullptr, &pool_));
    device_.set_name(VK_OBJECT_TYPE_COMMAND_POOL, reinterpret_cast<uint64_t>(pool_), "window");
    for (Frame& frame : frames_) {
        const VkCommandBufferAllocateInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                   .commandPool = pool_,
                                                   .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                   .commandBufferCount = 1};
        SHVR_VK(vkAllocateCommandBuffers(device_.handle(), &commands, &frame.commands));
        const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        SHVR_VK(vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &frame.acquired));
        const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                      .flags = VK_FENCE_CREATE_SIGNALED_BIT};
        SHVR_VK(vkCreateFence(device_.handle(), &fence, nullptr, &frame.done));
    }
}

void Swapchain::create_imgui()
{
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 8};
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
                                          .maxSets = 8,
                                          .poolSizeCount = 1,
                                          .pPoolSizes = &size};
    SHVR_VK(vkCreateDescriptorPool(device_.handle(), &info, nullptr, &descriptors_));
    ImGui_ImplVulkan_InitInfo init{};
    init.Instance = device_.instance();
    init.PhysicalDevice = device_.physical();
    init.Device = device_.handle();
    init.QueueFamily = device_.queue_family();
    init.Queue = device_.queue();
    init.DescriptorPool = descriptors_;
    init.MinImageCount = 2;
    init.ImageCount = uint32_t(std::max<size_t>(targets_.size(), FRAMES_IN_FLIGHT));
    init.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    init.CheckVkResultFn = [](VkResult result) { gpu::check(result, "Dear ImGui"); };
    ImGui_ImplVulkan_Init(&init, render_pass_);
    imgui_is_ready_ = true;

    const VkCommandBuffer commands = frames_[0].commands;
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    SHVR_VK(vkBeginCommandBuffer(commands, &begin));
    ImGui_ImplVulkan_CreateFontsTexture(commands);
    SHVR_VK(vkEndCommandBuffer(commands));
    const VkCommandBufferSubmitInfo submitted{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                              .commandBuffer = commands};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &submitted};
    SHVR_VK(vkQueueSubmit2(device_.queue(), 1, &submit, VK_NULL_HANDLE));
    device_.wait_idle();
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Swapchain::renew_fonts()
{
    device_.wait_idle();
    if (std::exchange(imgui_is_ready_, false)) ImGui_ImplVulkan_Shutdown();
    vkDestroyDescriptorPool(device_.handle(), std::exchange(descriptors_, VK_NULL_HANDLE), nullptr);
    create_imgui();
}

void Swapchain::create_swapchain()
{
    device_.wait_idle();
    destroy_targets();
    VkSurfaceCapabilitiesKHR capabilities;
    SHVR_VK(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &capabilities));
    extent_ = capabilities.currentExtent;
    if (extent_.width == ~0u) {  // the surface accepts any size
        glm::ivec2 size(0);
        glfwGetFramebufferSize(window_, &size.x, &size.y);
        extent_ = {uint32_t(size.x), uint32_t(size.y)};
    }
    if (extent_.width == 0 || extent_.height == 0) return;  // minimised
    uint32_t images = std::max(capabilities.minImageCount, FRAMES_IN_FLIGHT);
    if (capabilities.maxImageCount > 0) images = std::min(images, capabilities.maxImageCount);
    const VkSwapchainKHR old = swapchain_;
    const VkSwapchainCreateInfoKHR info{
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = surface_,
        .minImageCount = images,
        .imageFormat = format_.format,
        .imageColorSpace = format_.colorSpace,
        .imageExtent = extent_,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .preTransform = capabilities.currentTransform,
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
        .clipped = VK_TRUE,
        .oldSwapchain = old};
    swapchain_ = VK_NULL_HANDLE;
    const VkResult result = vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &swapchain_);
    if (old) vkDestroySwapchainKHR(device_.handle(), old, nullptr);
    gpu::check(result, "vkCreateSwapchainKHR");

    const auto chain = gpu::enumerate<VkImage>(
        [&](uint32_t* count, VkImage* items) { vkGetSwapchainImagesKHR(device_.handle(), swapchain_, count, items); });
    for (VkImage image : chain) add_target(image);
}

void Swapchain::add_target(VkImage image)
{
    Target& target = targets_.emplace_back();
    target.image = image;
    device_.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image), "swapchain");
    const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                     .image = image,
                                     .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                     .format = format_.format,
                                     .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    SHVR_VK(vkCreateImageView(device_.handle(), &view, nullptr, &target.view));
    const VkFramebufferCreateInfo framebuffer{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                              .renderPass = render_pass_,
                                              .attachmentCount = 1,
                                              .pAttachments = &target.view,
                                              .width = extent_.width,
                                              .height = extent_.height,
                                              .layers = 1};
    SHVR_VK(vkCreateFramebuffer(device_.handle(), &framebuffer, nullptr, &target.framebuffer));
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    SHVR_VK(vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &target.drawn));
}

void Swapchain::destroy_targets()
{
    for (const Target& target : targets_) {
        vkDestroySemaphore(device_.handle(), target.drawn, nullptr);
        vkDestroyFramebuffer(device_.handle(), target.framebuffer, nullptr);
        vkDestroyImageView(device_.handle(), target.view, nullptr);
    }
    targets_.clear();
}

void Swapchain::destroy()
{
    vkDeviceWaitIdle(device_.handle());
    if (imgui_is_ready_) ImGui_ImplVulkan_Shutdown();
    destroy_targets();
    vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
    for (const Frame& frame : frames_) {
        vkDestroyFence(device_.handle(), frame.done, nullptr);
        vkDestroySemaphore(device_.handle(), frame.acquired, nullptr);
    }
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
    vkDestroyDescriptorPool(device_.handle(), descriptors_, nullptr);
    vkDestroyRenderPass(device_.handle(), render_pass_, nullptr);
    vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

void Swapchain::draw_layers(VkCommandBuffer commands, VkImage target, const std::vector<View::Layer>& layers,
                            const glm::uvec2& origin) const
{
    const glm::ivec2 window_size(extent_.width, extent_.height);
    const VkImageSubresourceLayers color{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    for (size_t first = 0; first < layers.size();) {
        const VkImage source = memory_.object(layers[first].image.id).image;
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
            if (first > 0)  // overwrites earlier copies
                memory_barrier(commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                               VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
            // A copy, not a blit: on a software device a blit of the whole view takes longer than the whole interface.
            vkCmdCopyImage(commands, source, VK_IMAGE_LAYOUT_GENERAL, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                           uint32_t(regions.size()), regions.data());
        }
        first = last;
    }
}

void Swapchain::record(const Frame& frame, const Target& target, const std::vector<View::Layer>& layers,
                       const glm::uvec2& origin) const
{
    constexpr VkPipelineStageFlags2 TRANSFER = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    constexpr VkPipelineStageFlags2 WORK = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | TRANSFER;
    const VkCommandBuffer commands = frame.commands;
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    SHVR_VK(vkBeginCommandBuffer(commands, &begin));
    device_.begin_label(commands, "window");
    image_barrier(commands, target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, TRANSFER, 0,
                  TRANSFER, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &BACKDROP, 1, &whole);
    // The writes of the view's frames and the clear come before the copy of the layers.
    memory_barrier(commands, WORK, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT, TRANSFER,
                   VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    draw_layers(commands, target.image, layers, origin);
    // The view's next frames must wait for the copy before they write: their graphs do not know this reader.
    memory_barrier(commands, TRANSFER, 0, WORK, 0);
    image_barrier(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, TRANSFER, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                  VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    const VkRenderPassBeginInfo pass{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                     .renderPass = render_pass_,
                                     .framebuffer = target.framebuffer,
                                     .renderArea = {{0, 0}, extent_}};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
    vkCmdEndRenderPass(commands);
    device_.end_label(commands);
    SHVR_VK(vkEndCommandBuffer(commands));
}

bool Swapchain::present(const std::vector<View::Layer>& layers, const glm::uvec2& origin)
{
    glm::ivec2 size(0);
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    if (size.x <= 0 || size.y <= 0) return false;
    if (!swapchain_ || extent_.width != uint32_t(size.x) || extent_.height != uint32_t(size.y)) create_swapchain();
    if (targets_.empty()) return false;

    Frame& frame = frames_[next_frame_];
    SHVR_VK(vkWaitForFences(device_.handle(), 1, &frame.done, VK_TRUE, UINT64_MAX));
    uint32_t index = 0;
    VkResult acquired =
        vkAcquireNextImageKHR(device_.handle(), swapchain_, UINT64_MAX, frame.acquired, VK_NULL_HANDLE, &index);
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
        create_swapchain();
        return false;
    }
    gpu::check(acquired, "vkAcquireNextImageKHR");
    SHVR_VK(vkResetFences(device_.handle(), 1, &frame.done));
    record(frame, targets_[index], layers, origin);

    const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                             .commandBuffer = frame.commands};
    const VkSemaphoreSubmitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                     .semaphore = frame.acquired,
                                     .stageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT};
    const VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                       .semaphore = targets_[index].drawn,
                                       .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .waitSemaphoreInfoCount = 1,
                               .pWaitSemaphoreInfos = &wait,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &commands,
                               .signalSemaphoreInfoCount = 1,
                               .pSignalSemaphoreInfos = &signal};
    SHVR_VK(vkQueueSubmit2(device_.queue(), 1, &submit, frame.done));
    frame.number = ++presented_;
    next_frame_ = (next_frame_ + 1) % FRAMES_IN_FLIGHT;
    const VkPresentInfoKHR present_info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                        .waitSemaphoreCount = 1,
                                        .pWaitSemaphores = &targets_[index].drawn,
                                        .swapchainCount = 1,
                                        .pSwapchains = &swapchain_,
                                        .pImageIndices = &index};
    const VkResult shown = vkQueuePresentKHR(device_.queue(), &present_info);
    if (shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR)
        create_swapchain();
    else
        gpu::check(shown, "vkQueuePresentKHR");
    return true;
}

uint64_t Swapchain::frames_done() const
{
    uint64_t done = 0;
    uint64_t running = presented_ + 1;
    for (const Frame& frame : frames_)
        if (vkGetFenceStatus(device_.handle(), frame.done) == VK_SUCCESS)
            done = std::max(done, frame.number);
        else
            running = std::min(running, frame.number);
    return std::min(done, running - 1);
}

}  // namespace shvr::ui
