// A frame of the window: what is recorded, submitted and presented, and what is left of one that fails.

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

/// Makes what an abandoned frame lacks.
void Swapchain::complete(Frame& frame) const
{
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    if (!frame.acquired) SHVR_VK(vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &frame.acquired));
    const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    if (!frame.done) SHVR_VK(vkCreateFence(device_.handle(), &fence, nullptr, &frame.done));
}

/// After a failure half way: its semaphore may be signalled and its fence never be, and an image may be acquired that
/// is never presented. All of them go.
void Swapchain::abandon(Frame& frame)
{
    vkDeviceWaitIdle(device_.handle());
    vkDestroySemaphore(device_.handle(), std::exchange(frame.acquired, VK_NULL_HANDLE), nullptr);
    vkDestroyFence(device_.handle(), std::exchange(frame.done, VK_NULL_HANDLE), nullptr);
    is_stale_ = true;
}

bool Swapchain::present(const std::vector<View::Layer>& layers, const glm::uvec2& origin)
{
    glm::ivec2 size(0);
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    if (size.x <= 0 || size.y <= 0) return false;
    Frame& frame = frames_[next_frame_];
    try {
        if (extent_.width != uint32_t(size.x) || extent_.height != uint32_t(size.y)) {
            is_as_good_as_it_gets_ = false;
            is_stale_ = true;
        }
        if (!swapchain_ || is_stale_) create_swapchain();
        if (targets_.empty()) return false;
        complete(frame);
        return show(frame, layers, origin);
    } catch (const SurfaceLost&) {
        abandon(frame);
        renew_surface();
        return false;
    } catch (...) {
        abandon(frame);
        throw;
    }
}

/// Whether it was shown, or will be.
bool Swapchain::show(Frame& frame, const std::vector<View::Layer>& layers, const glm::uvec2& origin)
{
    SHVR_VK(vkWaitForFences(device_.handle(), 1, &frame.done, VK_TRUE, UINT64_MAX));
    uint32_t index = 0;
    VkResult acquired =
        vkAcquireNextImageKHR(device_.handle(), swapchain_, UINT64_MAX, frame.acquired, VK_NULL_HANDLE, &index);
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
        is_stale_ = true;
        return false;
    }
    check(acquired, "vkAcquireNextImageKHR");
    record(frame, targets_[index], layers, origin);
    SHVR_VK(vkResetFences(device_.handle(), 1, &frame.done));

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
    if (shown == VK_ERROR_OUT_OF_DATE_KHR)
        is_stale_ = true;
    else if (shown == VK_SUBOPTIMAL_KHR)  // some stay so however often they are made anew
        is_stale_ = !std::exchange(is_as_good_as_it_gets_, true);
    else
        check(shown, "vkQueuePresentKHR");
    return true;
}

uint64_t Swapchain::frames_done() const
{
    uint64_t done = 0;
    uint64_t running = presented_ + 1;
    for (const Frame& frame : frames_)
        if (!frame.done || vkGetFenceStatus(device_.handle(), frame.done) == VK_SUCCESS)
            done = std::max(done, frame.number);
        else
            running = std::min(running, frame.number);
    return std::min(done, running - 1);
}

}  // namespace shvr::ui
