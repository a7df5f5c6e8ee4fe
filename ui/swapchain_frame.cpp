// Draws a frame of the window: recording, submission, presentation, and cleaning up after failures.

#include "ui/swapchain.h"

#include <algorithm>
#include <chrono>
#include <exception>
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
            // Skips layers that are larger than the window, which may have shrunk since they were drawn.
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
            // Not a blit: on a software device, a blit of the whole view takes longer than the interface.
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
    constexpr VkAccessFlags2 WRITES = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
    const VkCommandBuffer commands = frame.commands;
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    SHVR_VK(vkBeginCommandBuffer(commands, &begin));
    device_.begin_label(commands, "window");
    image_barrier(commands, target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, TRANSFER, 0,
                  TRANSFER, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &BACKDROP, 1, &whole);
    // The copy of the layers must wait for the clear and for the writes of the view's frames.
    memory_barrier(commands, WORK, WRITES, TRANSFER, VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    draw_layers(commands, target.image, layers, origin);
    // The view's next frames must not write before this copy has read: their render graphs do not know about the copy.
    // The barrier also makes earlier writes visible. That costs nothing here, and avoids false reports of validation
    // (1.3.239): when an image is acquired, validation counts all work as in flight again that was in flight when the
    // image was presented, and would report reads after writes of frames that had long been waited for.
    memory_barrier(commands, WORK, WRITES, WORK, WRITES | VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT);
    image_barrier(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, TRANSFER, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                  VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    const VkRenderPassBeginInfo pass{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                     .renderPass = render_pass_,
                                     .framebuffer = target.framebuffer,
                                     .renderArea = {{0, 0}, extent_}};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    // The back end grows its buffers to these totals. The totals never decrease, so that a buffer that could not be
    // allocated is requested again, instead of being used while too small.
    ImDrawData& drawn = *ImGui::GetDrawData();
    drawn.TotalVtxCount = max_vertices_ = std::max(max_vertices_, drawn.TotalVtxCount);
    drawn.TotalIdxCount = max_indices_ = std::max(max_indices_, drawn.TotalIdxCount);
    ImGui_ImplVulkan_RenderDrawData(&drawn, commands);
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

/// Cleans up after a failure in the middle of a frame. The frame's semaphore may be signalled, its fence may never be
/// signalled, and an acquired image may never be presented: destroys all of these, and discards the recorded work.
void Swapchain::abandon(Frame& frame)
{
    device_.wait_idle_or_lost();
    static_cast<void>(vkResetCommandBuffer(frame.commands, 0));
    acquired_.reset();
    vkDestroySemaphore(device_.handle(), std::exchange(frame.acquired, VK_NULL_HANDLE), nullptr);
    vkDestroyFence(device_.handle(), std::exchange(frame.done, VK_NULL_HANDLE), nullptr);
    is_stale_ = true;
}

template <class Try>
bool Swapchain::attempt(const Try& attempted)
{
    Frame& frame = frames_[next_frame_];
    try {
        return attempted(frame);
    } catch (const SurfaceLost&) {
        abandon(frame);
        renew_surface();
        return false;
    } catch (...) {
        abandon(frame);
        throw;
    }
}

bool Swapchain::is_ready()
{
    return attempt([this](Frame& frame) { return prepare(frame); });
}

bool Swapchain::present(const std::vector<View::Layer>& layers, const glm::uvec2& origin, const Meanwhile& meanwhile)
{
    // An exception in `meanwhile` is rethrown after the frame is presented, since the frame is already submitted.
    std::exception_ptr failure;
    const Meanwhile safely = [&](double wait_ms) {
        try {
            if (meanwhile) meanwhile(wait_ms);
        } catch (...) {
            failure = std::current_exception();
        }
    };
    const bool is_shown = attempt([&](Frame& frame) { return prepare(frame) && show(frame, layers, origin, safely); });
    if (failure) std::rethrow_exception(failure);
    return is_shown;
}

/// Makes sure that the frame has an image to draw in. Returns false if none is available.
bool Swapchain::prepare(Frame& frame)
{
    glm::ivec2 size(0);
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    if (size.x <= 0 || size.y <= 0) return false;
    // Tries twice: a new swapchain may be out of date at once, and no caller tries the frame again.
    for (int tries = 0; tries < 2; ++tries) {
        if (!swapchain_ || size != made_for_) is_stale_ = true;
        if (is_stale_ && !create_swapchain()) return false;
        complete(frame);
        if (acquired_ || acquire(frame)) return true;
        if (!is_stale_) return false;
    }
    return false;
}

/// Acquires an image if one is available. May set `is_stale_`, so that the swapchain is re-created.
bool Swapchain::acquire(Frame& frame)
{
    constexpr uint64_t PATIENCE_NS = 10'000'000;  // some drivers have no image ready right after creating a swapchain
    // Like vkGetFenceStatus, but also tells the validation layer that the frame has been waited for.
    const VkResult status = vkWaitForFences(device_.handle(), 1, &frame.done, VK_TRUE, 0);
    check(status, "vkWaitForFences");
    if (status == VK_TIMEOUT) return false;
    device_.note_done(frame.submission);
    taken_ = std::max(taken_, frame.follows);
    free_retired();
    uint32_t index = 0;
    const VkResult acquired =
        vkAcquireNextImageKHR(device_.handle(), swapchain_, patient_acquisitions_ > 0 ? PATIENCE_NS : 0, frame.acquired,
                              VK_NULL_HANDLE, &index);
    if (patient_acquisitions_ > 0) --patient_acquisitions_;
    if (acquired == VK_NOT_READY || acquired == VK_TIMEOUT) return false;
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
        is_stale_ = true;
        return false;
    }
    check(acquired, "vkAcquireNextImageKHR");
    acquired_ = index;
    return true;
}

/// Compares the capabilities, since some surfaces remain suboptimal however often their swapchain is re-created.
bool Swapchain::surface_has_changed() const
{
    VkSurfaceCapabilitiesKHR now{};
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &now),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    return now.currentExtent.width != made_of_.currentExtent.width ||
           now.currentExtent.height != made_of_.currentExtent.height ||
           now.currentTransform != made_of_.currentTransform;
}

/// Draws into the acquired image and presents it. Returns false if the image is lost.
bool Swapchain::show(Frame& frame, const std::vector<View::Layer>& layers, const glm::uvec2& origin,
                     const Meanwhile& meanwhile)
{
    const uint32_t index = *acquired_;
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
    check(vkQueueSubmit2(device_.queue(), 1, &submit, frame.done), "vkQueueSubmit2");
    acquired_.reset();
    frame.submission = last_submission_ = device_.note_submission();
    frame.number = ++presented_;
    frame.follows = std::exchange(targets_[index].presented, frame.number);
    next_frame_ = (next_frame_ + 1) % FRAMES_IN_FLIGHT;
    const VkPresentInfoKHR present_info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                        .waitSemaphoreCount = 1,
                                        .pWaitSemaphores = &targets_[index].drawn,
                                        .swapchainCount = 1,
                                        .pSwapchains = &swapchain_,
                                        .pImageIndices = &index};
    if (const double wait_ms = expected_wait_ms(); wait_ms > 0.0) meanwhile(wait_ms);
    const VkResult shown = hand_to_screen(present_info);
    if (shown == VK_ERROR_OUT_OF_DATE_KHR)
        is_stale_ = true;
    else if (shown == VK_SUBOPTIMAL_KHR)
        is_stale_ = surface_has_changed();
    else
        check(shown, "vkQueuePresentKHR");
    return shown != VK_ERROR_OUT_OF_DATE_KHR;
}

/// Presents, and measures how long that waits for the screen: where images are shown in turn, many drivers wait until
/// the queue has room.
VkResult Swapchain::hand_to_screen(const VkPresentInfoKHR& info)
{
    const auto begun = std::chrono::steady_clock::now();
    const VkResult result = vkQueuePresentKHR(device_.queue(), &info);
    const std::chrono::duration<double, std::milli> waited = std::chrono::steady_clock::now() - begun;
    std::ranges::rotate(waits_ms_, waits_ms_.begin() + 1);
    waits_ms_.back() = waited.count();
    return result;
}

/// Returns the expected wait for the screen at the next presentation; 0 if it is too short to be used for work.
double Swapchain::expected_wait_ms() const
{
    constexpr double MIN_MS = 1.0, MAX_MS = 50.0;  // longer waits, when the screen is slow for a while, count as MAX_MS
    // Uses the shortest of the last waits, since a single long wait may be an exception. Mailbox mode never waits.
    const double wait_ms = std::min(*std::ranges::min_element(waits_ms_), MAX_MS);
    return mode_ == VK_PRESENT_MODE_FIFO_KHR && wait_ms >= MIN_MS ? wait_ms : 0.0;
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
