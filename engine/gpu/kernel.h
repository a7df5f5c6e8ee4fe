#pragma once
// Kernels: SPIR-V, reflected once, and one pipeline per set of specialization constants. Bindings are matched by the
// names in the GLSL source. A missing, unknown or wrongly used name is an error whose message lists the kernel's
// declarations.

#include <array>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/pipeline_cache.h"
#include "engine/graph/frame_graph.h"

namespace shvr::gpu {

/// A kernel's declarations, read from its SPIR-V.
struct KernelInterface {
    struct Slot {
        std::string name;
        uint32_t binding = 0;
        VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        bool readable = true;
        bool writable = true;
        bool is_flat = false;     ///< images: 2-D
        bool by_address = false;  ///< a block that begins with the address of the buffer that the pass binds
    };
    struct Constant {
        std::string name;
        uint32_t id = 0;
    };
    struct Member {
        std::string name;
        uint32_t offset = 0;
    };
    std::vector<Slot> slots;  ///< by binding number
    std::vector<Constant> constants;
    std::array<uint32_t, 3> local_size{1, 1, 1};
    uint32_t push_bytes = 0;
    /// Members of the push block and of the structs in storage blocks, by block name. Tests compare their offsets with
    /// offsetof, so that GLSL and C++ agree.
    std::map<std::string, std::vector<Member>> members;

    const Slot* slot(const std::string& name) const;
};

KernelInterface reflect(const std::string& kernel, std::span<const uint32_t> spirv);

/// A compute pipeline with its layouts. Move-only.
class Kernel {
public:
    Kernel(Device& device, PipelineCache& cache, const KernelVariant& variant, std::span<const uint32_t> spirv,
           const KernelInterface& interface);
    ~Kernel();
    Kernel(const Kernel&) = delete;
    Kernel& operator=(const Kernel&) = delete;

    const KernelInterface& interface() const { return interface_; }
    VkPipeline pipeline() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_; }
    VkDescriptorSetLayout set_layout() const { return set_layout_; }

private:
    void create_layouts();
    void create_pipeline(PipelineCache& cache, std::span<const uint32_t> spirv,
                         const VkSpecializationInfo& specialization);
    void destroy() noexcept;
    Device& device_;
    const KernelInterface& interface_;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

/// All kernels of the program, created on first use. On a GPU a worker thread first compiles the kernels used in the
/// last run (pipeline_cache.h), then those that graphs expect. Only one thread may call `get`.
class Kernels {
public:
    explicit Kernels(Device& device);
    ~Kernels();
    Kernels(const Kernels&) = delete;
    Kernels& operator=(const Kernels&) = delete;

    /// Returns a kernel; if the worker is compiling it, waits. Errors list the known kernels or constants.
    const Kernel& get(const std::string& name, const std::vector<std::pair<std::string, uint32_t>>& constants);
    const KernelInterface& interface(const std::string& name);
    /// Hints that these kernels will probably be needed. The worker compiles them if the device option `looks_ahead` is
    /// set (gpu::DeviceOptions).
    void expect(std::span<const KernelVariant> variants);
    /// Number of kernels that the worker still has to compile.
    size_t expected() const;

private:
    struct Code {
        std::span<const uint32_t> spirv;
        KernelInterface interface;
    };
    struct Made {
        std::unique_ptr<Kernel> kernel;
        bool is_in_work = false;
        bool is_used = false;  ///< `get` has returned this kernel
    };
    const Code& code(const std::string& name);
    Made& make(const KernelVariant& variant);
    void work() noexcept;

    Device& device_;
    PipelineCache cache_;
    mutable std::mutex mutex_;  ///< guards all of the following members
    std::map<std::string, Code> codes_;
    std::map<KernelVariant, Made> kernels_;
    std::deque<KernelVariant> expected_;  ///< kernels to compile; the first one is being compiled
    std::condition_variable is_made_, has_work_;
    bool ends_ = false;
    std::thread worker_;
};

/// Checks a compute pass's bindings against its kernel's declarations. The error message lists both sets.
void check_bindings(const PassData& pass, const KernelInterface& interface,
                    const std::vector<FrameGraph::ResourceData>& resources);

}  // namespace shvr::gpu
