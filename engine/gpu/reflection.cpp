// SPIR-V reflection through SPIRV-Cross's C interface: reads a kernel's declarations and their GLSL names.

#include <algorithm>
#include <optional>

#include <spirv_cross_c.h>

#include "engine/gpu/kernel.h"

namespace shvr::gpu {

namespace {

struct Reflector {
    const std::string& kernel;
    spvc_context context = nullptr;
    spvc_compiler compiler = nullptr;
    spvc_resources resources = nullptr;

    explicit Reflector(const std::string& name, std::span<const uint32_t> spirv) : kernel(name)
    {
        spvc_parsed_ir ir = nullptr;
        require(spvc_context_create(&context));
        require(spvc_context_parse_spirv(context, spirv.data(), spirv.size(), &ir));
        require(
            spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler));
        require(spvc_compiler_create_shader_resources(compiler, &resources));
    }
    ~Reflector() { spvc_context_destroy(context); }
    Reflector(const Reflector&) = delete;
    Reflector& operator=(const Reflector&) = delete;

    void require(spvc_result result) const
    {
        if (result != SPVC_SUCCESS)
            fail("kernel '", kernel,
                 "' cannot be reflected: ", context ? spvc_context_get_last_error_string(context) : "out of memory");
    }

    std::span<const spvc_reflected_resource> list(spvc_resource_type type) const
    {
        const spvc_reflected_resource* items = nullptr;
        size_t count = 0;
        require(spvc_resources_get_resource_list_for_type(resources, type, &items, &count));
        return {items, count};
    }

    std::vector<KernelInterface::Member> members(spvc_type_id id) const
    {
        spvc_type type = spvc_compiler_get_type_handle(compiler, id);
        std::vector<KernelInterface::Member> members;
        for (unsigned i = 0; i < spvc_type_get_num_member_types(type); ++i) {
            unsigned offset = 0;
            require(spvc_compiler_type_struct_member_offset(compiler, type, i, &offset));
            members.push_back({spvc_compiler_get_member_name(compiler, spvc_type_get_base_type_id(type), i), offset});
        }
        return members;
    }

    /// Returns a block's members or, if the block only holds a struct or an array of structs, the struct's members.
    std::vector<KernelInterface::Member> block_members(spvc_type_id id) const
    {
        spvc_type block = spvc_compiler_get_type_handle(compiler, id);
        if (spvc_type_get_num_member_types(block) == 1) {
            const spvc_type_id inner = spvc_type_get_member_type(block, 0);
            if (spvc_type_get_basetype(spvc_compiler_get_type_handle(compiler, inner)) == SPVC_BASETYPE_STRUCT)
                return members(spvc_type_get_base_type_id(spvc_compiler_get_type_handle(compiler, inner)));
        }
        return members(id);
    }

    /// If a block begins with the address of words (buffer_reference), returns these words' type.
    std::optional<spvc_type_id> addressed(spvc_type_id id) const
    {
        spvc_type block = spvc_compiler_get_type_handle(compiler, id);
        if (spvc_type_get_num_member_types(block) == 0) return std::nullopt;
        spvc_type first = spvc_compiler_get_type_handle(compiler, spvc_type_get_member_type(block, 0));
        if (spvc_type_get_storage_class(first) != SpvStorageClassPhysicalStorageBuffer) return std::nullopt;
        return spvc_type_get_base_type_id(first);
    }

    void add_slots(KernelInterface& interface, spvc_resource_type kind, VkDescriptorType type) const
    {
        for (const spvc_reflected_resource& resource : list(kind)) {
            KernelInterface::Slot slot{
                .name = spvc_compiler_get_name(compiler, resource.id),
                .binding = spvc_compiler_get_decoration(compiler, resource.id, SpvDecorationBinding),
                .type = type};
            if (slot.name.empty()) slot.name = resource.name;
            bool read_only = spvc_compiler_has_decoration(compiler, resource.id, SpvDecorationNonWritable);
            bool write_only = spvc_compiler_has_decoration(compiler, resource.id, SpvDecorationNonReadable);
            if (type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER) {
                const SpvDecoration* decorations = nullptr;
                size_t count = 0;
                require(spvc_compiler_get_buffer_block_decorations(compiler, resource.id, &decorations, &count));
                read_only |= std::count(decorations, decorations + count, SpvDecorationNonWritable) > 0;
                write_only |= std::count(decorations, decorations + count, SpvDecorationNonReadable) > 0;
                interface.members[slot.name] = block_members(resource.base_type_id);
                if (const std::optional<spvc_type_id> words = addressed(resource.base_type_id)) {
                    slot.by_address = true;
                    read_only = spvc_compiler_has_member_decoration(compiler, *words, 0, SpvDecorationNonWritable);
                    write_only = spvc_compiler_has_member_decoration(compiler, *words, 0, SpvDecorationNonReadable);
                }
            }
            slot.writable = !read_only && type != VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
            slot.readable = !write_only;
            if (type != VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)
                slot.is_flat = spvc_type_get_image_dimension(
                                   spvc_compiler_get_type_handle(compiler, resource.type_id)) == SpvDim2D;
            interface.slots.push_back(slot);
        }
    }
};

}  // namespace

KernelInterface reflect(const std::string& kernel, std::span<const uint32_t> spirv)
{
    const Reflector reflector(kernel, spirv);
    KernelInterface interface;
    reflector.add_slots(interface, SPVC_RESOURCE_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
    reflector.add_slots(interface, SPVC_RESOURCE_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE);
    reflector.add_slots(interface, SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
    std::sort(interface.slots.begin(), interface.slots.end(),
              [](const auto& a, const auto& b) { return a.binding < b.binding; });
    for (size_t i = 1; i < interface.slots.size(); ++i)
        if (interface.slots[i].binding == interface.slots[i - 1].binding)
            fail("kernel '", kernel, "': '", interface.slots[i - 1].name, "' and '", interface.slots[i].name,
                 "' share binding ", interface.slots[i].binding);

    for (const spvc_reflected_resource& block : reflector.list(SPVC_RESOURCE_TYPE_PUSH_CONSTANT)) {
        size_t bytes = 0;
        reflector.require(spvc_compiler_get_declared_struct_size(
            reflector.compiler, spvc_compiler_get_type_handle(reflector.compiler, block.base_type_id), &bytes));
        interface.push_bytes = uint32_t(bytes);
        interface.members["push"] = reflector.block_members(block.base_type_id);
    }

    const spvc_specialization_constant* constants = nullptr;
    size_t count = 0;
    reflector.require(spvc_compiler_get_specialization_constants(reflector.compiler, &constants, &count));
    for (size_t i = 0; i < count; ++i)
        interface.constants.push_back(
            {spvc_compiler_get_name(reflector.compiler, constants[i].id), constants[i].constant_id});
    for (unsigned axis = 0; axis < 3; ++axis)
        interface.local_size[axis] =
            spvc_compiler_get_execution_mode_argument_by_index(reflector.compiler, SpvExecutionModeLocalSize, axis);
    return interface;
}

}  // namespace shvr::gpu
