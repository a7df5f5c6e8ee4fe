#pragma once
// The frame graph: the work of one frame, as plain data. It does not depend on Vulkan and is tested without a device.
//
// Every frame is declared from scratch, in order, by ordinary code: a pass is a function from handles to handles, and a
// condition is an `if`. Writing a resource returns a new version of its handle and invalidates the old one, so passes
// cannot be declared in a wrong order: a stale handle is refused, and the message names the resource, both versions and
// the line of the pass that invalidated it. `compile()` drops unused passes and derives the barriers. Its result is a
// list of steps, which an executor records, and which tests and `shvr profile --graph` print. A handle exists only
// after the pass that made it, so the order of declaration is a valid order of execution, and the steps keep it.
//
// Images stay in one layout (GENERAL), so global stage-to-stage memory barriers suffice, at most one per step.
//
// One thread builds and compiles a graph. Errors in a graph are programming errors, but they are thrown as `Error` so
// that tests can check each of them.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <source_location>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/error.h"
#include "engine/graph/kernel_variants.h"

namespace shvr {

enum class Format : uint8_t { r8_uint, r16_unorm, r32_uint, rgba32_uint, rgba32_float, rgba8_unorm };
uint64_t bytes_per_texel(Format format);
const char* name_of(Format format);

struct ResourceDesc {
    enum class Kind : uint8_t { buffer, image };
    Kind kind = Kind::buffer;
    Format format = Format::r32_uint;  ///< images
    bool is_flat = false;              ///< images: 2-D rather than 3-D, with larger size limits; z is 1
    bool by_address = false;           ///< buffers: kernels get the address and `texels` (see words_desc)
    glm::uvec3 texels{1};              ///< images; if not flat, the image is 3-D even if z is 1
    uint64_t bytes = 0;                ///< buffers: size; images: texels * bytes per texel
    bool operator==(const ResourceDesc&) const = default;
};
ResourceDesc buffer_desc(uint64_t bytes);
/// Describes a buffer of words in a grid, x fastest, without gaps. A kernel gets its address and the grid's size in a
/// block (a `buffer_reference` and a uvec3), so limits of bound buffers do not apply.
ResourceDesc words_desc(const glm::uvec3& words);
ResourceDesc image_desc(Format format, const glm::uvec3& texels);
/// Describes a 2-D image, for a picture, or for a table stored in rows.
ResourceDesc picture_desc(Format format, const glm::uvec2& texels);

/// A handle to one version of a resource. Cheap to copy; valid only in the graph that made it.
struct Resource {
    uint32_t index = ~0u;
    uint32_t version = 0;
    bool operator==(const Resource&) const = default;
};

/// Pipeline stages, as a bit set.
using Stages = uint8_t;
inline constexpr Stages STAGE_COMPUTE = 1;
inline constexpr Stages STAGE_TRANSFER = 2;
inline constexpr Stages STAGE_HOST = 4;
std::string names_of(Stages stages);

/// The accesses to a resource that are still in flight. Imported resources carry this state from frame to frame.
struct ResourceState {
    Stages written_by = 0;   ///< stages of the last write
    Stages visible_to = 0;   ///< stages to which the last write is visible
    Stages read_by = 0;      ///< stages that have read since the last write
    Stages after_reads = 0;  ///< stages ordered after all reads in `read_by`
    bool operator==(const ResourceState&) const = default;
};
/// The state of an object whose earlier uses are unknown: its first use waits for everything.
inline constexpr ResourceState UNKNOWN_STATE{STAGE_COMPUTE | STAGE_TRANSFER, 0, STAGE_COMPUTE | STAGE_TRANSFER, 0};

/// An object that outlives the frame. `id` is the executor's number for it.
struct Import {
    uint32_t id = 0;
    ResourceDesc desc;
    ResourceState state = UNKNOWN_STATE;
};

struct Barrier {
    Stages from = 0;
    Stages to = 0;
    bool memory = false;  ///< false: execution order only, as for a write after a read
    bool operator==(const Barrier&) const = default;
};

struct Binding {
    std::string name;  ///< name of the GLSL variable (images) or block instance (buffers)
    uint32_t resource = 0;
    bool reads = false;
    bool writes = false;
};

struct ImageRegion {
    uint64_t buffer_offset = 0;  ///< bytes; texels are tightly packed, x fastest
    glm::uvec3 texel{0};
    glm::uvec3 texels{0};
};
struct BufferRegion {
    uint64_t source_offset = 0;
    uint64_t target_offset = 0;
    uint64_t bytes = 0;
};

struct PassData {
    enum class Kind : uint8_t { compute, fill, copy_to_image, copy_buffer, read_back };
    std::string name;
    Kind kind = Kind::compute;
    std::string kernel;
    std::vector<Binding> bindings;
    std::vector<std::pair<std::string, uint32_t>> constants;             ///< specialization constants by name
    std::vector<std::byte> push;                                         ///< push constants
    std::vector<std::pair<std::string, std::vector<std::byte>>> blocks;  ///< small read-only buffers by block name
    glm::uvec3 threads{0};
    glm::uvec3 tile{0};  ///< maximum threads per dispatch, to keep dispatches short; 0: no limit
    uint32_t fill_value = 0;
    uint32_t read_back = 0;  ///< index into FrameResult::read_backs
    std::vector<ImageRegion> image_regions;
    std::vector<BufferRegion> buffer_regions;
    std::source_location declared_at;
};

class FrameGraph;

/// Adds bindings and settings to a pass while the pass is being declared.
class Pass {
public:
    void read(const std::string& name, Resource resource);
    [[nodiscard]] Resource write(const std::string& name, Resource resource);
    /// Declares that the pass reads and writes the resource in place.
    [[nodiscard]] Resource modify(const std::string& name, Resource resource);
    void constant(const std::string& name, uint32_t value);
    /// Sets push constants, at most 128 bytes. The executor checks that their size is that of the kernel's block.
    template <class T>
    void push(const T& value)
    {
        static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 128);
        set_push(std::as_bytes(std::span(&value, 1)));
    }
    /// Binds a small read-only buffer with these values, which the executor creates for this pass alone.
    template <class T>
    void block(const std::string& name, std::span<const T> values)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        add_block(name, std::as_bytes(values));
    }
    /// `threads` counts threads, not groups; the group size comes from the kernel. `tile` is the size of one dispatch,
    /// to split the work into several short submissions. Its sides must be multiples of the group size.
    void dispatch(const glm::uvec3& threads, const glm::uvec3& tile = glm::uvec3(0));

private:
    friend class FrameGraph;
    Pass(FrameGraph& graph, uint32_t index) : graph_(graph), index_(index) {}
    Resource use(const std::string& name, Resource resource, bool reads, bool writes);
    void set_push(std::span<const std::byte> bytes);
    void add_block(const std::string& name, std::span<const std::byte> bytes);
    FrameGraph& graph_;
    uint32_t index_;
};

struct Step {
    uint32_t pass = 0;               ///< index into FrameGraph::passes()
    std::optional<Barrier> barrier;  ///< before the pass
};

struct CompiledGraph {
    std::vector<Step> steps;
    std::vector<ResourceState> final_states;  ///< per resource
    std::vector<bool> used;                   ///< for each resource, whether any kept pass uses it
    /// For each resource, the resource whose memory it uses: itself, or an equal resource of this frame that no later
    /// step needs. If several resources share memory in turn, the index is that of the first.
    std::vector<uint32_t> memory_of;
};

class FrameGraph {
public:
    using Location = std::source_location;

    /// Adds a resource that outlives the frame. Passes that write it are always kept, as the write is a side effect.
    Resource import(const std::string& name, const Import& import);
    /// Adds a resource that only exists in this frame. It must be written before it is read.
    Resource create(const std::string& name, const ResourceDesc& desc);

    /// Adds a buffer that only exists in this frame; the executor fills it with `values`.
    template <class T>
    Resource upload(const std::string& name, std::span<const T> values)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        return upload_bytes(name, std::as_bytes(values));
    }

    /// Adds a compute pass, named `name` or by default after its kernel; a kernel that runs repeatedly needs a `name`.
    Pass compute(const std::string& kernel, const std::string& name = {}, Location at = Location::current());
    /// Likewise for a kernel with variants (kernel_variants.h). `choices` gives a value to each macro in the kernel's
    /// line "// variants: ...", in any order. Fails if a macro is unknown, missing or named twice.
    Pass compute(const std::string& kernel, std::initializer_list<VariantChoice> choices, const std::string& name = {},
                 Location at = Location::current());
    /// Sets every 4 bytes of a buffer, or every texel of an integer image, to `value`.
    [[nodiscard]] Resource fill(Resource target, uint32_t value, const std::string& name = "fill",
                                Location at = Location::current());
    [[nodiscard]] Resource copy_to_image(Resource buffer, Resource image, std::vector<ImageRegion> regions,
                                         const std::string& name = "upload", Location at = Location::current());
    [[nodiscard]] Resource copy(Resource from, Resource to, std::vector<BufferRegion> regions,
                                const std::string& name = "copy", Location at = Location::current());
    /// Requests a copy of the whole resource at the end of the frame, and keeps the passes that wrote it. Returns an
    /// index into `FrameResult::read_backs`.
    uint32_t read_back(Resource resource, const std::string& name = {}, Location at = Location::current());
    /// Announces that a later graph will probably use `kernel`, so that an executor can compile it in the background.
    void expect(KernelVariant kernel) { expected_.push_back(std::move(kernel)); }

    /// Keeps the passes that wrote `resource`, even if nothing in this graph reads it.
    void keep(Resource resource);

    CompiledGraph compile() const;

    /// Registers a rollback of state that was changed on the assumption that this graph will run. If the graph and all
    /// of its copies are destroyed without being submitted, the rollbacks run, last one first. `undo` must not fail,
    /// and everything that it refers to must outlive the graph.
    void unless_submitted(std::function<void()> undo);
    /// Marks the graph as submitted, so that no rollback runs. For executors.
    void note_submitted() const;

    struct ResourceData {
        std::string name;
        ResourceDesc desc;
        bool imported = false;
        uint32_t import_id = 0;
        ResourceState state;  ///< accesses in flight before the frame; none for resources of this frame alone
        uint32_t version = 0;
        std::vector<uint32_t> writers;    ///< at index i, the pass that made version i + 1
        std::vector<std::byte> contents;  ///< the bytes of an upload
        bool kept = false;
    };
    const std::vector<PassData>& passes() const { return passes_; }
    const std::vector<ResourceData>& resources() const { return resources_; }
    const std::vector<KernelVariant>& expected() const { return expected_; }
    uint32_t read_back_count() const { return read_backs_; }

private:
    friend class Pass;
    Resource upload_bytes(const std::string& name, std::span<const std::byte> bytes);
    PassData& add(PassData::Kind kind, const std::string& name, Location at);
    Resource use(uint32_t pass, const std::string& name, Resource resource, bool reads, bool writes);

    std::vector<PassData> passes_;
    std::vector<ResourceData> resources_;
    std::vector<KernelVariant> expected_;
    uint32_t read_backs_ = 0;
    struct Undo;
    std::shared_ptr<Undo> undo_;  ///< shared by copies
};

}  // namespace shvr
