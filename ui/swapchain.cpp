#include "ui/swapchain.h"

#include <algorithm>
#include <utility>

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

#include "ui/imgui_versions.h"

namespace shvr::ui {

void Swapchain::check(VkResult result, const char* call) const
{
    if (result == VK_ERROR_SURFACE_LOST_KHR) throw SurfaceLost(sentence(call, ": the window's surface is lost"));
    device_.check(result, call);
}

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
    create_surface();
    choose_format();
    create_render_pass();
    create_frames();
    create_swapchain();
    create_imgui();
}

void Swapchain::create_surface()
{
    SHVR_VK(glfwCreateWindowSurface(device_.instance(), window_, nullptr, &surface_));
    VkBool32 presents = VK_FALSE;
    SHVR_VK(vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical(), device_.queue_family(), surface_, &presents));
    if (!presents)
        fail("device ", device_.traits().name, " cannot show pictures in this window; --device chooses another");
}

namespace {

/// Prefers opaque composition. If that is unsupported any other mode works, since every pixel is drawn opaque.
VkCompositeAlphaFlagBitsKHR alpha_of(const VkSurfaceCapabilitiesKHR& capabilities)
{
    for (const auto one : {VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR, VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
                           VK_COMPOSITE_ALPHA_PRE_MULTIPLIED_BIT_KHR})
        if (capabilities.supportedCompositeAlpha & one) return one;
    return VK_COMPOSITE_ALPHA_POST_MULTIPLIED_BIT_KHR;
}

/// Prefers mailbox: a newer picture replaces one that the screen has not shown yet, so presentation does not wait for
/// the screen. Without mailbox, all pictures are shown in turn, and with some drivers presentation then waits.
VkPresentModeKHR mode_of(VkPhysicalDevice physical, VkSurfaceKHR surface)
{
    const auto modes = gpu::enumerate<VkPresentModeKHR>([&](uint32_t* count, VkPresentModeKHR* items) {
        vkGetPhysicalDeviceSurfacePresentModesKHR(physical, surface, count, items);
    });
    const bool has_mailbox = std::ranges::find(modes, VK_PRESENT_MODE_MAILBOX_KHR) != modes.end();
    return has_mailbox ? VK_PRESENT_MODE_MAILBOX_KHR : VK_PRESENT_MODE_FIFO_KHR;
}

constexpr VkImageUsageFlags USAGE = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;

}  // namespace

/// Re-creates only the surface; the next frame then re-creates the swapchain.
void Swapchain::renew_surface()
{
    device_.wait_idle();
    destroy_swapchains();
    vkDestroySurfaceKHR(device_.instance(), std::exchange(surface_, VK_NULL_HANDLE), nullptr);
    create_surface();
    const VkSurfaceFormatKHR before = format_;
    choose_format();
    if (format_.format != before.format)
        fail("the window's new surface has another format than before; close and start again to go on");
}

void Swapchain::choose_format()
{
    const auto formats = gpu::enumerate<VkSurfaceFormatKHR>([&](uint32_t* count, VkSurfaceFormatKHR* items) {
        vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, count, items);
    });
    // The layers are already encoded and are copied byte by byte, so the format must not encode them again. Some
    // drivers also list such formats with the colour spaces of HDR screens: sRGB is preferred.
    for (const bool any_space : {false, true})
        for (const VkSurfaceFormatKHR& candidate : formats) {
            const bool has_8_bits =
                candidate.format == VK_FORMAT_B8G8R8A8_UNORM || candidate.format == VK_FORMAT_R8G8B8A8_UNORM;
            if (!has_8_bits || (!any_space && candidate.colorSpace != VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)) continue;
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
        complete(frame);
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
    init_imgui_vulkan(init, render_pass_);
    imgui_is_ready_ = true;

    const VkCommandBuffer commands = frames_[0].commands;
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    SHVR_VK(vkBeginCommandBuffer(commands, &begin));
    upload_imgui_fonts(commands);
    SHVR_VK(vkEndCommandBuffer(commands));
    const VkCommandBufferSubmitInfo submitted{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                              .commandBuffer = commands};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &submitted};
    SHVR_VK(vkQueueSubmit2(device_.queue(), 1, &submit, VK_NULL_HANDLE));
    device_.wait_idle();
    end_imgui_font_upload();
}

void Swapchain::renew_fonts()
{
    device_.wait_idle();
    if (std::exchange(imgui_is_ready_, false)) ImGui_ImplVulkan_Shutdown();
    vkDestroyDescriptorPool(device_.handle(), std::exchange(descriptors_, VK_NULL_HANDLE), nullptr);
    create_imgui();
}

/// Creates a swapchain without waiting for the device; the previous one is freed later. Returns false if minimised.
bool Swapchain::create_swapchain()
{
    if (!surface_) create_surface();  // an earlier attempt lost the surface and could not re-create it
    glfwGetFramebufferSize(window_, &made_for_.x, &made_for_.y);
    VkSurfaceCapabilitiesKHR& capabilities = made_of_;
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &capabilities),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    if ((capabilities.supportedUsageFlags & USAGE) != USAGE)
        fail("device ", device_.traits().name,
             " cannot copy pictures into this window; expected one that can, which --device chooses");
    extent_ = capabilities.currentExtent;
    if (extent_.width == ~0u) {  // the surface accepts any size
        const VkExtent2D &least = capabilities.minImageExtent, &most = capabilities.maxImageExtent;
        extent_ = {std::clamp(uint32_t(made_for_.x), least.width, most.width),
                   std::clamp(uint32_t(made_for_.y), least.height, most.height)};
    }
    if (extent_.width == 0 || extent_.height == 0) return false;
    mode_ = mode_of(device_.physical(), surface_);
    waits_ms_ = {};
    uint32_t images = std::max(capabilities.minImageCount + 1, IMAGES);
    if (capabilities.maxImageCount > 0) images = std::min(images, capabilities.maxImageCount);
    const VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                        .surface = surface_,
                                        .minImageCount = images,
                                        .imageFormat = format_.format,
                                        .imageColorSpace = format_.colorSpace,
                                        .imageExtent = extent_,
                                        .imageArrayLayers = 1,
                                        .imageUsage = USAGE,
                                        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                        .preTransform = capabilities.currentTransform,
                                        .compositeAlpha = alpha_of(capabilities),
                                        .presentMode = mode_,
                                        .clipped = VK_TRUE,
                                        .oldSwapchain = retire()};
    check(vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &swapchain_), "vkCreateSwapchainKHR");
    is_stale_ = true;  // stale until it has all its targets
    const auto chain = gpu::enumerate<VkImage>([&](uint32_t* count, VkImage* items) {
        SHVR_VK(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, count, items));
    });
    for (VkImage image : chain) add_target(image);
    patient_acquisitions_ = uint32_t(chain.size());
    is_stale_ = false;
    return true;
}

/// Retires the swapchain and an acquired but unused image. Returns the old swapchain, needed to create the next one.
VkSwapchainKHR Swapchain::retire()
{
    if (!swapchain_) return VK_NULL_HANDLE;
    Retired& old = retired_.emplace_back();
    old.swapchain = std::exchange(swapchain_, VK_NULL_HANDLE);
    old.targets = std::exchange(targets_, {});
    old.submission = last_submission_;
    for (const Target& target : old.targets) old.presented = std::max(old.presented, target.presented);
    if (std::exchange(acquired_, std::nullopt))
        old.acquired = std::exchange(frames_[next_frame_].acquired, VK_NULL_HANDLE);
    return old.swapchain;
}

/// Frees swapchains whose frames have been drawn by the device and taken by the screen. A frame is known to be taken
/// only once Vulkan returns an image that was shown later. While a window's edge is dragged, every frame has its own
/// swapchain, which never gets an image back. Only the last of these are kept: an older one is freed once the device
/// has finished a later submission, or all submissions.
void Swapchain::free_retired()
{
    constexpr size_t MOST = 2;
    while (!retired_.empty()) {
        const Retired& oldest = retired_.front();
        const bool was_taken = oldest.submission <= device_.done() && oldest.presented <= taken_;
        const bool is_overtaken =
            retired_.size() > MOST && (oldest.submission < device_.done() || device_.done() == device_.submitted());
        if (!was_taken && !is_overtaken) return;
        destroy(oldest);
        retired_.pop_front();
    }
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

void Swapchain::destroy(const Retired& retired) const
{
    for (const Target& target : retired.targets) {
        vkDestroySemaphore(device_.handle(), target.drawn, nullptr);
        vkDestroyFramebuffer(device_.handle(), target.framebuffer, nullptr);
        vkDestroyImageView(device_.handle(), target.view, nullptr);
    }
    vkDestroySemaphore(device_.handle(), retired.acquired, nullptr);
    vkDestroySwapchainKHR(device_.handle(), retired.swapchain, nullptr);
}

/// The device is idle.
void Swapchain::destroy_swapchains()
{
    retire();
    for (const Retired& retired : retired_) destroy(retired);
    retired_.clear();
}

void Swapchain::destroy()
{
    vkDeviceWaitIdle(device_.handle());
    if (imgui_is_ready_) ImGui_ImplVulkan_Shutdown();
    destroy_swapchains();
    for (const Frame& frame : frames_) {
        vkDestroyFence(device_.handle(), frame.done, nullptr);
        vkDestroySemaphore(device_.handle(), frame.acquired, nullptr);
    }
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
    vkDestroyDescriptorPool(device_.handle(), descriptors_, nullptr);
    vkDestroyRenderPass(device_.handle(), render_pass_, nullptr);
    vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

}  // namespace shvr::ui
