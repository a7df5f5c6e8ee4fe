#include "engine/gpu/memory.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace shvr::gpu {

namespace {

/// Memory types in order of preference; every implementation has the last one.
std::optional<uint32_t> memory_type(const VkPhysicalDeviceMemoryProperties& properties, uint32_t allowed,
                                    std::initializer_list<VkMemoryPropertyFlags> wishes)
{
    for (VkMemoryPropertyFlags wish : wishes)
        for (uint32_t i = 0; i < properties.memoryTypeCount; ++i)
            if ((allowed >> i & 1) && (properties.memoryTypes[i].propertyFlags & wish) == wish) return i;
    return std::nullopt;
}

std::optional<uint32_t> memory_type(const VkPhysicalDeviceMemoryProperties& properties, uint32_t allowed,
                                    Placement placement)
{
    const VkMemoryPropertyFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    switch (placement) {
        case Placement::device: return memory_type(properties, allowed, {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0});
        case Placement::upload: return memory_type(properties, allowed, {mapped});
        case Placement::download:
            return memory_type(properties, allowed, {mapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, mapped});
    }
    return std::nullopt;
}

}  // namespace

std::string mebibytes(uint64_t bytes)
{
    constexpr uint64_t TENTHS = 10, MIB = uint64_t{1} << 20;
    const uint64_t tenths = bytes / MIB * TENTHS + (bytes % MIB * TENTHS + MIB - 1) / MIB;
    return sentence(double(tenths) / double(TENTHS), " MiB");
}

VkFormat vulkan_format(Format format)
{
    switch (format) {
        case Format::r8_uint: return VK_FORMAT_R8_UINT;
        case Format::r16_unorm: return VK_FORMAT_R16_UNORM;
        case Format::r32_uint: return VK_FORMAT_R32_UINT;
        case Format::rgba32_float: return VK_FORMAT_R32G32B32A32_SFLOAT;
        case Format::rgba8_unorm: return VK_FORMAT_R8G8B8A8_UNORM;
    }
    return VK_FORMAT_UNDEFINED;
}

Storage& Storage::operator=(Storage&& other) noexcept
{
    if (this == &other) return *this;
    reset();
    memory_ = std::exchange(other.memory_, nullptr);
    id_ = other.id_;
    return *this;
}

void Storage::reset()
{
    if (memory_) memory_->wait_idle();  // a frame in flight may still use it
    reset_idle();
}

void Storage::reset_idle()
{
    if (memory_) memory_->release(id_);
    memory_ = nullptr;
}

const ResourceDesc& Storage::desc() const
{
    SHVR_CHECK(memory_ != nullptr);
    return memory_->object(id_).desc;
}

Import Storage::import() const
{
    SHVR_CHECK(memory_ != nullptr);
    const Memory::Object& object = memory_->object(id_);
    return {.id = id_, .desc = object.desc, .state = object.state};
}

std::span<std::byte> Storage::mapped() const
{
    SHVR_CHECK(memory_ != nullptr);
    const Memory::Object& object = memory_->object(id_);
    SHVR_CHECK(object.mapped != nullptr, object.name);
    return {object.mapped, size_t(object.desc.bytes)};
}

Memory::Memory(Device& device, const Budget& budget) : device_(device), budget_(budget)
{
    if (budget_.device_bytes == 0) budget_.device_bytes = device.traits().device_bytes / 4 * 3;
    if (budget_.host_bytes == 0) budget_.host_bytes = uint64_t(1) << 30;
}

Memory::~Memory()
{
    SHVR_CHECK(objects_.empty(), objects_.size(), " storages outlive their memory, one is '",
               objects_.begin()->second.name, "'");
}

Memory::Object& Memory::object(uint32_t id)
{
    const auto found = objects_.find(id);
    SHVR_CHECK(found != objects_.end(), "storage ", id);
    return found->second;
}

void Memory::free_idle()
{
    if (free_idle_) free_idle_();
}

Storage Memory::create(const std::string& name, const ResourceDesc& desc, Placement placement, const char* purpose)
{
    const VkPhysicalDeviceLimits& limits = device_.traits().limits;
    Object object{.name = name, .desc = desc, .placement = placement};
    try {
        VkMemoryRequirements needs{};
        if (desc.kind == ResourceDesc::Kind::buffer) {
            const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                          .size = desc.bytes,
                                          .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                                   VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
            SHVR_VK(vkCreateBuffer(device_.handle(), &info, nullptr, &object.buffer));
            device_.set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(object.buffer), name);
            vkGetBufferMemoryRequirements(device_.handle(), object.buffer, &needs);
        } else {
            if (glm::any(glm::greaterThan(desc.texels, glm::uvec3(limits.maxImageDimension3D))))
                fail("image '", name, "' is ", desc.texels.x, " x ", desc.texels.y, " x ", desc.texels.z,
                     " texels; the device allows ", limits.maxImageDimension3D, " a side");
            const bool filtered = desc.format == Format::r16_unorm;
            const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                         .imageType = VK_IMAGE_TYPE_3D,
                                         .format = vulkan_format(desc.format),
                                         .extent = {desc.texels.x, desc.texels.y, desc.texels.z},
                                         .mipLevels = 1,
                                         .arrayLayers = 1,
                                         .samples = VK_SAMPLE_COUNT_1_BIT,
                                         .tiling = VK_IMAGE_TILING_OPTIMAL,
                                         .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                                  VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                                  (filtered ? VkImageUsageFlags(VK_IMAGE_USAGE_SAMPLED_BIT) : 0u)};
            SHVR_VK(vkCreateImage(device_.handle(), &info, nullptr, &object.image));
            device_.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(object.image), name);
            vkGetImageMemoryRequirements(device_.handle(), object.image, &needs);
        }
        allocate(object, needs, purpose);
        if (object.image) {
            SHVR_VK(vkBindImageMemory(device_.handle(), object.image, object.memory, 0));
            const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                             .image = object.image,
                                             .viewType = VK_IMAGE_VIEW_TYPE_3D,
                                             .format = vulkan_format(desc.format),
                                             .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
            SHVR_VK(vkCreateImageView(device_.handle(), &info, nullptr, &object.view));
            device_.set_name(VK_OBJECT_TYPE_IMAGE_VIEW, reinterpret_cast<uint64_t>(object.view), name);
        } else {
            SHVR_VK(vkBindBufferMemory(device_.handle(), object.buffer, object.memory, 0));
        }
    } catch (...) {
        destroy(object);
        throw;
    }
    const uint32_t id = next_id_++;
    objects_.emplace(id, std::move(object));
    return {*this, id};
}

void Memory::refuse(bool on_device, uint64_t bytes, const char* purpose) const
{
    const uint64_t used = on_device ? device_bytes_ : host_bytes_;
    const uint64_t budget = on_device ? budget_.device_bytes : budget_.host_bytes;
    if (on_device)
        throw BudgetError(sentence("device memory: ", purpose, " needs ", mebibytes(bytes), ", and ",
                                   mebibytes(budget - used), " of ", mebibytes(budget),
                                   " are left; expected a larger budget, as --budget-device ",
                                   (2 * (used + bytes) >> 20) + 1, " gives"));
    throw BudgetError(sentence("host memory: ", purpose, " needs ", mebibytes(bytes), ", and ",
                               mebibytes(budget - used), " of ", mebibytes(budget),
                               " for transfers are left; expected a larger budget, as --budget-host ",
                               (2 * (used + bytes) >> 19) + 1, " gives"));
}

void Memory::allocate(Object& object, const VkMemoryRequirements& needs, const char* purpose)
{
    const bool on_device = object.placement == Placement::device;
    uint64_t& used = on_device ? device_bytes_ : host_bytes_;
    uint64_t& peak = on_device ? peak_device_bytes_ : peak_host_bytes_;
    const uint64_t budget = on_device ? budget_.device_bytes : budget_.host_bytes;
    const auto fits = [&] { return needs.size <= budget && used <= budget - needs.size; };
    if (!fits()) free_idle();
    if (!fits()) refuse(on_device, needs.size, purpose);
    const auto type = memory_type(device_.memory_properties(), needs.memoryTypeBits, object.placement);
    if (!type) fail("device ", device_.traits().name, " has no memory type for '", object.name, "'");
    const VkMemoryAllocateInfo info{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = *type};
    const VkResult result = vkAllocateMemory(device_.handle(), &info, nullptr, &object.memory);
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        fail("the device is out of memory: ", purpose, " needs ", mebibytes(needs.size), "; SHVR uses ",
             mebibytes(used), "; a smaller --budget-device may help");
    check(result, "vkAllocateMemory");
    object.bytes = needs.size;
    used += needs.size;
    peak = std::max(peak, used);
    device_.set_name(VK_OBJECT_TYPE_DEVICE_MEMORY, reinterpret_cast<uint64_t>(object.memory), object.name);
    if (on_device) return;
    void* mapped = nullptr;
    SHVR_VK(vkMapMemory(device_.handle(), object.memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    object.mapped = static_cast<std::byte*>(mapped);
}

void Memory::destroy(Object& object) noexcept
{
    if (object.view) vkDestroyImageView(device_.handle(), object.view, nullptr);
    if (object.image) vkDestroyImage(device_.handle(), object.image, nullptr);
    if (object.buffer) vkDestroyBuffer(device_.handle(), object.buffer, nullptr);
    if (object.memory) {
        vkFreeMemory(device_.handle(), object.memory, nullptr);
        (object.placement == Placement::device ? device_bytes_ : host_bytes_) -= object.bytes;
    }
}

void Memory::wait_idle() const noexcept
{
    vkDeviceWaitIdle(device_.handle());
}

void Memory::release(uint32_t id) noexcept
{
    const auto found = objects_.find(id);
    if (found == objects_.end()) return;
    destroy(found->second);
    objects_.erase(found);
}

std::map<std::string, uint64_t> Memory::bytes_by_name() const
{
    std::map<std::string, uint64_t> bytes;
    for (const auto& [id, object] : objects_) bytes[object.name] += object.bytes;
    return bytes;
}

}  // namespace shvr::gpu
