#include "engine/gpu/memory.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/base/machine/machine.h"

namespace shvr::gpu {

namespace {

VkImageUsageFlags usage_of(Format format)
{
    const bool is_filtered = format == Format::r16_unorm;
    return VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
           (is_filtered ? VkImageUsageFlags(VK_IMAGE_USAGE_SAMPLED_BIT) : 0u);
}

VkImageType type_of(const ResourceDesc& desc)
{
    return desc.is_flat ? VK_IMAGE_TYPE_2D : VK_IMAGE_TYPE_3D;
}

std::string sides(uint32_t x, uint32_t y, uint32_t z)
{
    return sentence(x, " x ", y, " x ", z);
}

/// Whether a result means that memory ran out; drivers report this by several codes.
bool is_shortage(VkResult result)
{
    switch (result) {
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        case VK_ERROR_OUT_OF_HOST_MEMORY:
        case VK_ERROR_TOO_MANY_OBJECTS:
        case VK_ERROR_UNKNOWN: return true;
        default: return false;
    }
}

/// The bytes that other programs leave free. A device on the processor takes the process's own memory: a quarter of it.
std::optional<uint64_t> bytes_left(const Device& device)
{
    const std::optional<uint64_t> left = device.heap_bytes_left();
    if (!device.traits().is_cpu) return left;
    const uint64_t share = memory_allowed() / 4;
    return std::min(left.value_or(share), share);
}

}  // namespace

/// The last set of flags matches a memory type on every Vulkan implementation.
std::vector<uint32_t> memory_types(const VkPhysicalDeviceMemoryProperties& properties, uint32_t allowed,
                                   Placement placement)
{
    const VkMemoryPropertyFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryPropertyFlags wish = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, must = 0;
    if (placement == Placement::upload) wish = must = mapped;
    if (placement == Placement::values) wish = mapped | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, must = mapped;
    if (placement == Placement::download) wish = mapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, must = mapped;
    // Memory types with these properties are for special purposes, and the program may be unable to use them.
    const VkMemoryPropertyFlags never = VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT | VK_MEMORY_PROPERTY_PROTECTED_BIT |
                                        VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD |
                                        VK_MEMORY_PROPERTY_DEVICE_UNCACHED_BIT_AMD;
    std::vector<uint32_t> types;
    for (const VkMemoryPropertyFlags flags : {wish, must})
        for (uint32_t i = 0; i < properties.memoryTypeCount; ++i) {
            const VkMemoryPropertyFlags has = properties.memoryTypes[i].propertyFlags;
            if (!(allowed >> i & 1) || (has & flags) != flags || (has & never)) continue;
            if (std::ranges::find(types, i) == types.end()) types.push_back(i);
        }
    return types;
}

float memory_priority(const ResourceDesc& desc, Placement placement)
{
    constexpr float USUAL = 0.5f, HIGHEST = 1.0f;
    const bool is_picture = desc.kind == ResourceDesc::Kind::image && desc.is_flat;
    const bool is_read_by_kernels = placement == Placement::device || placement == Placement::values;
    return is_read_by_kernels && !is_picture ? HIGHEST : USUAL;
}

uint64_t automatic_device_bytes(const DeviceTraits& traits, std::optional<uint64_t> left)
{
    const uint64_t share = traits.is_integrated ? traits.device_bytes / 2 : traits.device_bytes / 4 * 3;
    return left ? std::min(share, *left) : share;
}

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
        case Format::rgba32_uint: return VK_FORMAT_R32G32B32A32_UINT;
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
    if (memory_) memory_->release(id_, false);
    memory_ = nullptr;
}

void Storage::reset_idle()
{
    if (memory_) memory_->release(id_, true);
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
    if (budget_.device_bytes == 0) budget_.device_bytes = automatic_device_bytes(device.traits(), bytes_left(device));
    if (budget_.host_bytes == 0) budget_.host_bytes = uint64_t(1) << 30;
}

Memory::~Memory()
{
    SHVR_CHECK(objects_.empty(), objects_.size(), " storages outlive their memory, one is '",
               objects_.begin()->second.name, "'");
    free_all_retired();
    for (const auto& block : blocks_) vkFreeMemory(device_.handle(), block->memory, nullptr);
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

std::optional<std::string> Memory::why_not(const std::string& name, const ResourceDesc& desc, Placement placement) const
{
    const DeviceTraits& traits = device_.traits();
    const auto too_large = [&](const char* kind, uint64_t allowed) {
        return sentence(kind, " '", name, "' takes ", mebibytes(desc.bytes), "; the device allows ",
                        mebibytes(allowed));
    };
    if (desc.kind == ResourceDesc::Kind::buffer) {
        uint64_t allowed = std::min(traits.max_allocation_bytes, traits.max_buffer_bytes);
        if (placement == Placement::device && !desc.by_address)
            allowed = std::min(allowed, uint64_t(traits.limits.maxStorageBufferRange));
        return desc.bytes > allowed ? std::optional(too_large("buffer", allowed)) : std::nullopt;
    }
    const glm::uvec3& texels = desc.texels;
    VkImageFormatProperties image{};
    const VkResult result =
        vkGetPhysicalDeviceImageFormatProperties(device_.physical(), vulkan_format(desc.format), type_of(desc),
                                                 VK_IMAGE_TILING_OPTIMAL, usage_of(desc.format), 0, &image);
    if (result == VK_ERROR_FORMAT_NOT_SUPPORTED)
        return sentence("image '", name, "' is of the format ", name_of(desc.format),
                        ", which the device does not have for ", desc.is_flat ? 2 : 3, "-D images");
    check(result, "vkGetPhysicalDeviceImageFormatProperties");
    const VkExtent3D& most = image.maxExtent;
    if (texels.x > most.width || texels.y > most.height || texels.z > most.depth)
        return sentence("image '", name, "' is ", sides(texels.x, texels.y, texels.z), " texels; the device allows ",
                        sides(most.width, most.height, most.depth));
    const uint64_t allowed = std::min(uint64_t(image.maxResourceSize), traits.max_allocation_bytes);
    return desc.bytes > allowed ? std::optional(too_large("image", allowed)) : std::nullopt;
}

Storage Memory::create(const std::string& name, const ResourceDesc& desc, Placement placement, const char* purpose)
{
    if (const std::optional<std::string> why = why_not(name, desc, placement)) throw Error(*why);
    Object object{.name = name, .desc = desc, .placement = placement};
    try {
        if (desc.kind == ResourceDesc::Kind::buffer)
            create_buffer(object, purpose);
        else
            create_image(object, purpose);
    } catch (...) {
        destroy(object);
        throw;
    }
    const uint32_t id = next_id_++;
    objects_.emplace(id, std::move(object));
    return {*this, id};
}

void Memory::create_buffer(Object& object, const char* purpose)
{
    const VkBufferUsageFlags addressed = object.desc.by_address ? VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT : 0;
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                  .size = object.desc.bytes,
                                  .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                           VK_BUFFER_USAGE_TRANSFER_DST_BIT | addressed};
    SHVR_VK(vkCreateBuffer(device_.handle(), &info, nullptr, &object.buffer));
    device_.set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(object.buffer), object.name);
    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device_.handle(), object.buffer, &needs);
    allocate(object, needs, purpose);
    SHVR_VK(vkBindBufferMemory(device_.handle(), object.buffer, object.memory, object.offset));
    if (!object.desc.by_address) return;
    const VkBufferDeviceAddressInfo which{.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                          .buffer = object.buffer};
    object.address = vkGetBufferDeviceAddress(device_.handle(), &which);
}

void Memory::create_image(Object& object, const char* purpose)
{
    const ResourceDesc& desc = object.desc;
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = type_of(desc),
                                 .format = vulkan_format(desc.format),
                                 .extent = {desc.texels.x, desc.texels.y, desc.texels.z},
                                 .mipLevels = 1,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = usage_of(desc.format)};
    SHVR_VK(vkCreateImage(device_.handle(), &info, nullptr, &object.image));
    device_.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(object.image), object.name);
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device_.handle(), object.image, &needs);
    allocate(object, needs, purpose);
    SHVR_VK(vkBindImageMemory(device_.handle(), object.image, object.memory, object.offset));
    const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                     .image = object.image,
                                     .viewType = desc.is_flat ? VK_IMAGE_VIEW_TYPE_2D : VK_IMAGE_VIEW_TYPE_3D,
                                     .format = vulkan_format(desc.format),
                                     .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    SHVR_VK(vkCreateImageView(device_.handle(), &view, nullptr, &object.view));
    device_.set_name(VK_OBJECT_TYPE_IMAGE_VIEW, reinterpret_cast<uint64_t>(object.view), object.name);
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
    collect();
    if (!fits()) free_idle();
    if (!fits()) free_all_retired();
    if (!fits()) refuse(on_device, needs.size, purpose);
    if (!allocate_in_block(object, needs)) {
        const auto from_driver = [&] {
            uint32_t type = 0;
            return allocate_from_driver(needs.size, needs.memoryTypeBits, object, &object.memory, &type);
        };
        VkResult result = from_driver();
        if (is_shortage(result)) {
            free_idle();
            free_all_retired();
            result = from_driver();
        }
        if (is_shortage(result))
            throw MemoryError(sentence("the device is out of memory: ", purpose, " needs ", mebibytes(needs.size),
                                       "; SHVR uses ", mebibytes(device_bytes_ + host_bytes_), " of it in ",
                                       allocations_, " pieces; expected less beside it, or a smaller --budget-device"));
        check(result, "vkAllocateMemory");
    }
    object.bytes = needs.size;
    used += needs.size;
    peak = std::max(peak, used);
    if (object.block) return;
    device_.set_name(VK_OBJECT_TYPE_DEVICE_MEMORY, reinterpret_cast<uint64_t>(object.memory), object.name);
    if (!on_device) object.mapped = map(object.memory);
}

/// Allocates from the driver. On an integrated device any memory type will do, as all heaps share one memory.
VkResult Memory::allocate_from_driver(uint64_t bytes, uint32_t allowed, const Object& object, VkDeviceMemory* memory,
                                      uint32_t* type)
{
    const VkMemoryPriorityAllocateInfoEXT priority{.sType = VK_STRUCTURE_TYPE_MEMORY_PRIORITY_ALLOCATE_INFO_EXT,
                                                   .priority = memory_priority(object.desc, object.placement)};
    const bool has_priority = device_.traits().has_memory_priority;
    const VkMemoryAllocateFlagsInfo addressed{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                              .pNext = has_priority ? &priority : nullptr,
                                              .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    std::vector<uint32_t> types = memory_types(device_.memory_properties(), allowed, object.placement);
    if (types.empty()) fail("device ", device_.traits().name, " has no memory for what the host reads or writes");
    if (object.placement == Placement::device && !device_.traits().is_integrated)
        types.erase(types.begin() + 1, types.end());
    VkResult result = VK_SUCCESS;
    for (const uint32_t candidate : types) {
        const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                        .pNext = object.desc.by_address ? &addressed : addressed.pNext,
                                        .allocationSize = bytes,
                                        .memoryTypeIndex = candidate};
        result = vkAllocateMemory(device_.handle(), &info, nullptr, memory);
        if (result == VK_SUCCESS) {
            ++allocations_;
            ++allocations_made_;
            *type = candidate;
            return result;
        }
        *memory = VK_NULL_HANDLE;
        if (!is_shortage(result)) return result;
    }
    return result;
}

/// Puts a small object into a shared block. Returns false if the object must have its own allocation.
bool Memory::allocate_in_block(Object& object, const VkMemoryRequirements& needs)
{
    if (needs.size > MemoryBlock::MAX_SHARE || object.desc.by_address) return false;
    const bool is_image = object.image != VK_NULL_HANDLE;
    const auto take = [&](MemoryBlock& block) {
        if (block.placement != object.placement || block.holds_images != is_image) return false;
        if (!(needs.memoryTypeBits >> block.type & 1)) return false;
        const std::optional<uint64_t> offset = block.take(needs.size, needs.alignment);
        if (!offset) return false;
        object.memory = block.memory;
        object.offset = *offset;
        object.block = &block;
        if (block.mapped) object.mapped = block.mapped + *offset;
        return true;
    };
    for (const auto& block : blocks_)
        if (take(*block)) return true;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    uint32_t type = 0;
    if (allocate_from_driver(MemoryBlock::BYTES, needs.memoryTypeBits, object, &memory, &type) != VK_SUCCESS)
        return false;
    try {
        std::byte* const mapped = object.placement == Placement::device ? nullptr : map(memory);
        blocks_.push_back(std::make_unique<MemoryBlock>(memory, object.placement, is_image, type, mapped));
    } catch (...) {
        free_to_driver(memory);
        throw;
    }
    device_.set_name(VK_OBJECT_TYPE_DEVICE_MEMORY, reinterpret_cast<uint64_t>(memory),
                     is_image ? "small images" : "small buffers");
    return take(*blocks_.back());
}

std::byte* Memory::map(VkDeviceMemory memory) const
{
    void* mapped = nullptr;
    SHVR_VK(vkMapMemory(device_.handle(), memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    return static_cast<std::byte*>(mapped);
}

void Memory::free_to_driver(VkDeviceMemory memory) noexcept
{
    vkFreeMemory(device_.handle(), memory, nullptr);
    --allocations_;
}

void Memory::destroy(Object& object) noexcept
{
    if (object.view) vkDestroyImageView(device_.handle(), object.view, nullptr);
    if (object.image) vkDestroyImage(device_.handle(), object.image, nullptr);
    if (object.buffer) vkDestroyBuffer(device_.handle(), object.buffer, nullptr);
    if (!object.memory) return;
    (object.placement == Placement::device ? device_bytes_ : host_bytes_) -= object.bytes;
    if (!object.block) return free_to_driver(object.memory);
    object.block->give_back(object.offset);
    if (!object.block->is_empty()) return;
    // Keeps one empty block of each kind, since otherwise the next small object would have to allocate one again.
    const auto is_spare = [&](const auto& other) {
        return other.get() != object.block && other->is_empty() && other->placement == object.block->placement &&
               other->holds_images == object.block->holds_images;
    };
    if (std::ranges::none_of(blocks_, is_spare)) return;
    free_to_driver(object.block->memory);
    std::erase_if(blocks_, [&](const auto& block) { return block.get() == object.block; });
}

void Memory::release(uint32_t id, bool is_idle) noexcept
{
    const auto found = objects_.find(id);
    if (found == objects_.end()) return;
    Object object = std::move(found->second);
    objects_.erase(found);
    if (is_idle || device_.done() == device_.submitted()) return destroy(object);
    (object.placement == Placement::device ? retired_device_bytes_ : retired_host_bytes_) += object.bytes;
    retired_.push_back({device_.submitted(), std::move(object)});
}

void Memory::collect() noexcept
{
    for (; !retired_.empty() && retired_.front().last <= device_.done(); retired_.pop_front()) {
        Object& object = retired_.front().object;
        (object.placement == Placement::device ? retired_device_bytes_ : retired_host_bytes_) -= object.bytes;
        destroy(object);
    }
}

void Memory::free_all_retired() noexcept
{
    if (retired_.empty()) return;
    device_.wait_idle_or_lost();
    collect();
}

std::map<std::string, uint64_t> Memory::bytes_by_name() const
{
    std::map<std::string, uint64_t> bytes;
    for (const auto& [id, object] : objects_) bytes[object.name] += object.bytes;
    return bytes;
}

}  // namespace shvr::gpu
