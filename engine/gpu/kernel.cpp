#include "engine/gpu/kernel.h"

#include <algorithm>

#include "engine/gpu/embedded_kernels.h"

namespace shvr::gpu {

namespace {

template <class Items>
std::string names_of(const Items& items)
{
    std::string names;
    for (const auto& item : items) names += (names.empty() ? "" : ", ") + std::string(item.name);
    return names.empty() ? "nothing" : names;
}

}  // namespace

const KernelInterface::Slot* KernelInterface::slot(const std::string& name) const
{
    const auto found = std::find_if(slots.begin(), slots.end(), [&](const Slot& s) { return s.name == name; });
    return found == slots.end() ? nullptr : &*found;
}

void check_bindings(const PassData& pass, const KernelInterface& interface,
                    const std::vector<FrameGraph::ResourceData>& resources)
{
    const auto declared = [&](const std::string& name) {
        const KernelInterface::Slot* slot = interface.slot(name);
        if (!slot)
            fail("pass '", pass.name, "' binds '", name, "'; kernel '", pass.kernel, "' declares ",
                 names_of(interface.slots));
        return slot;
    };
    for (const Binding& binding : pass.bindings) {
        const KernelInterface::Slot* slot = declared(binding.name);
        const ResourceDesc& desc = resources[binding.resource].desc;
        const bool is_buffer = slot->type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        if (is_buffer != (desc.kind == ResourceDesc::Kind::buffer))
            fail("pass '", pass.name, "' binds '", binding.name, "' to '", resources[binding.resource].name, "', ",
                 is_buffer ? "an image; the kernel expects a buffer" : "a buffer; the kernel expects an image");
        if (slot->by_address != desc.by_address)
            fail("pass '", pass.name, "' binds '", binding.name, "' to '", resources[binding.resource].name, "', ",
                 desc.by_address ? "words with an address; the kernel expects a buffer"
                                 : "a buffer; the kernel expects words with an address");
        if (!is_buffer && slot->is_flat != desc.is_flat)
            fail("pass '", pass.name, "' binds '", binding.name, "' to '", resources[binding.resource].name, "', a ",
                 desc.is_flat ? 2 : 3, "-D image; the kernel expects a ", slot->is_flat ? 2 : 3, "-D one");
        if (binding.writes && !slot->writable)
            fail("pass '", pass.name, "' writes '", binding.name, "', which kernel '", pass.kernel, "' only reads");
        if (!binding.writes && slot->writable)
            fail("pass '", pass.name, "' only reads '", binding.name, "', which kernel '", pass.kernel,
                 "' may write; mark it readonly there");
        if (binding.reads && !slot->readable)
            fail("pass '", pass.name, "' reads '", binding.name, "', which kernel '", pass.kernel, "' only writes");
    }
    for (const auto& [name, bytes] : pass.blocks)
        if (declared(name)->writable)
            fail("pass '", pass.name, "' gives the values of '", name, "', which kernel '", pass.kernel,
                 "' may write; mark it readonly there");
    for (const KernelInterface::Slot& slot : interface.slots) {
        const bool bound =
            slot.name == "counters" ||  // owned by the executor
            std::any_of(pass.bindings.begin(), pass.bindings.end(),
                        [&](const auto& b) { return b.name == slot.name; }) ||
            std::any_of(pass.blocks.begin(), pass.blocks.end(), [&](const auto& b) { return b.first == slot.name; });
        if (!bound) fail("pass '", pass.name, "' leaves '", slot.name, "' of kernel '", pass.kernel, "' unbound");
    }
    if (pass.push.size() != interface.push_bytes)
        fail("pass '", pass.name, "' pushes ", pass.push.size(), " bytes; kernel '", pass.kernel, "' expects ",
             interface.push_bytes);
}

namespace {

struct Specialization {
    std::vector<VkSpecializationMapEntry> entries;
    std::vector<uint32_t> values;
};

Specialization specialize(const std::string& kernel, const KernelInterface& interface,
                          const std::vector<std::pair<std::string, uint32_t>>& constants)
{
    Specialization result;
    for (const auto& [constant, value] : constants) {
        const auto found = std::find_if(interface.constants.begin(), interface.constants.end(),
                                        [&, &name = constant](const auto& c) { return c.name == name; });
        if (found == interface.constants.end())
            fail("kernel '", kernel, "' has no specialization constant '", constant, "'; it has ",
                 names_of(interface.constants));
        result.entries.push_back({found->id, uint32_t(result.values.size() * sizeof(uint32_t)), sizeof(uint32_t)});
        result.values.push_back(value);
    }
    return result;
}

}  // namespace

Kernel::Kernel(Device& device, PipelineCache& cache, const KernelVariant& variant, std::span<const uint32_t> spirv,
               const KernelInterface& interface)
    : device_(device), interface_(interface)
{
    const auto& [name, constants] = variant;
    const Specialization specialization = specialize(name, interface, constants);
    try {
        create_layouts();
        create_pipeline(cache, spirv,
                        {.mapEntryCount = uint32_t(specialization.entries.size()),
                         .pMapEntries = specialization.entries.data(),
                         .dataSize = specialization.values.size() * sizeof(uint32_t),
                         .pData = specialization.values.data()});
    } catch (...) {
        destroy();
        throw;
    }
    device.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline_), name);
    device.set_name(VK_OBJECT_TYPE_PIPELINE_LAYOUT, reinterpret_cast<uint64_t>(layout_), name);
    device.set_name(VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, reinterpret_cast<uint64_t>(set_layout_), name);
}

Kernel::~Kernel()
{
    destroy();
}

void Kernel::destroy() noexcept
{
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
}

void Kernel::create_layouts()
{
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const KernelInterface::Slot& slot : interface_.slots)
        bindings.push_back({.binding = slot.binding,
                            .descriptorType = slot.type,
                            .descriptorCount = 1,
                            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT});
    const VkDescriptorSetLayoutCreateInfo set_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                   .bindingCount = uint32_t(bindings.size()),
                                                   .pBindings = bindings.data()};
    SHVR_VK(vkCreateDescriptorSetLayout(device_.handle(), &set_info, nullptr, &set_layout_));
    const VkPushConstantRange push{.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .size = interface_.push_bytes};
    const VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                                 .setLayoutCount = 1,
                                                 .pSetLayouts = &set_layout_,
                                                 .pushConstantRangeCount = interface_.push_bytes ? 1u : 0u,
                                                 .pPushConstantRanges = &push};
    SHVR_VK(vkCreatePipelineLayout(device_.handle(), &layout_info, nullptr, &layout_));
}

void Kernel::create_pipeline(PipelineCache& cache, std::span<const uint32_t> spirv,
                             const VkSpecializationInfo& specialization)
{
    const VkShaderModuleCreateInfo module_info{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = spirv.size_bytes(), .pCode = spirv.data()};
    VkShaderModule module = VK_NULL_HANDLE;
    SHVR_VK(vkCreateShaderModule(device_.handle(), &module_info, nullptr, &module));
    VkPipelineCreationFeedback feedback{}, of_stage{};
    const VkPipelineCreationFeedbackCreateInfo told{.sType = VK_STRUCTURE_TYPE_PIPELINE_CREATION_FEEDBACK_CREATE_INFO,
                                                    .pPipelineCreationFeedback = &feedback,
                                                    .pipelineStageCreationFeedbackCount = 1,
                                                    .pPipelineStageCreationFeedbacks = &of_stage};
    const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                           .pNext = &told,
                                           .flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT,  // tiles
                                           .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                     .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                     .module = module,
                                                     .pName = "main",
                                                     .pSpecializationInfo = &specialization},
                                           .layout = layout_};
    const VkResult result = vkCreateComputePipelines(device_.handle(), cache.handle(), 1, &info, nullptr, &pipeline_);
    vkDestroyShaderModule(device_.handle(), module, nullptr);
    check(result, "vkCreateComputePipelines");
    cache.note_made((feedback.flags & VK_PIPELINE_CREATION_FEEDBACK_VALID_BIT) &&
                    (feedback.flags & VK_PIPELINE_CREATION_FEEDBACK_APPLICATION_PIPELINE_CACHE_HIT_BIT));
}

Kernels::Kernels(Device& device) : device_(device), cache_(device)
{
    // On CPU devices there is no worker: drawing needs the cores, and the driver compiles each kernel on first use.
    if (device.traits().is_cpu || (cache_.likely().empty() && !device.looks_ahead())) return;
    expected_.assign(cache_.likely().begin(), cache_.likely().end());
    worker_ = std::thread([this] { work(); });
}

Kernels::~Kernels()
{
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    has_work_.notify_all();
    if (worker_.joinable()) worker_.join();
    std::set<KernelVariant> used;
    for (const auto& [variant, made] : kernels_)
        if (made.is_used) used.insert(variant);
    cache_.save(used);
}

/// Compiles expected kernels. A failure is not reported here: get() compiles the kernel again and reports it.
void Kernels::work() noexcept
{
    for (;;) {
        std::unique_lock lock(mutex_);
        has_work_.wait(lock, [this] { return ends_ || !expected_.empty(); });
        if (ends_) return;
        const KernelVariant variant = expected_.front();
        lock.unlock();
        try {
            make(variant);
        } catch (const std::exception&) {
        }
        lock.lock();
        expected_.pop_front();
    }
}

void Kernels::expect(std::span<const KernelVariant> variants)
{
    if (!device_.looks_ahead() || variants.empty()) return;
    const std::lock_guard lock(mutex_);
    for (const KernelVariant& variant : variants)
        if (kernels_.emplace(variant, Made()).second) expected_.push_back(variant);
    if (!expected_.empty()) has_work_.notify_all();
}

size_t Kernels::expected() const
{
    const std::lock_guard lock(mutex_);
    return expected_.size();
}

const Kernels::Code& Kernels::code(const std::string& name)
{
    const auto known = codes_.find(name);
    if (known != codes_.end()) return known->second;
    for (const EmbeddedKernel& kernel : embedded_kernels()) {
        if (name != kernel.name) continue;
        const std::span<const uint32_t> spirv(kernel.words, kernel.word_count);
        return codes_.emplace(name, Code{spirv, reflect(name, spirv)}).first->second;
    }
    fail("there is no kernel '", name, "'; expected one of ", names_of(embedded_kernels()));
}

Kernels::Made& Kernels::make(const KernelVariant& variant)
{
    std::unique_lock lock(mutex_);
    Made& made = kernels_[variant];
    is_made_.wait(lock, [&] { return !made.is_in_work; });
    if (made.kernel) return made;
    const Code& source = code(variant.first);
    made.is_in_work = true;
    lock.unlock();
    const auto is_done = [&] {
        lock.lock();
        made.is_in_work = false;
        is_made_.notify_all();
    };
    std::unique_ptr<Kernel> kernel;
    try {
        kernel = std::make_unique<Kernel>(device_, cache_, variant, source.spirv, source.interface);
    } catch (...) {
        is_done();
        throw;
    }
    is_done();
    made.kernel = std::move(kernel);
    return made;
}

const Kernel& Kernels::get(const std::string& name, const std::vector<std::pair<std::string, uint32_t>>& constants)
{
    Made& made = make({name, constants});
    made.is_used = true;
    return *made.kernel;
}

const KernelInterface& Kernels::interface(const std::string& name)
{
    const std::lock_guard lock(mutex_);
    return code(name).interface;
}

}  // namespace shvr::gpu
