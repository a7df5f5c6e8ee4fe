#include "engine/graph/frame_graph.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace shvr {

namespace {

std::string place(const PassData& pass)
{
    return sentence("pass '", pass.name, "' (", std::filesystem::path(pass.declared_at.file_name()).filename().string(),
                    ":", pass.declared_at.line(), ")");
}

Stages stages_of(const PassData& pass)
{
    return pass.kind == PassData::Kind::compute ? STAGE_COMPUTE : STAGE_TRANSFER;
}

/// Returns why a pass may not use this handle, as the end of a message; null if the handle is current.
std::optional<std::string> fault_of(Resource resource, const FrameGraph& graph)
{
    if (resource.index >= graph.resources().size()) return "a handle that this graph did not make";
    const FrameGraph::ResourceData& data = graph.resources()[resource.index];
    if (resource.version > data.version)
        return sentence("version ", resource.version, " of '", data.name, "', a handle that this graph did not make; ",
                        "the last version is ", data.version);
    if (resource.version < data.version)
        return sentence("version ", resource.version, " of '", data.name, "', which ",
                        place(graph.passes()[data.writers[resource.version]]), " replaced; the last version is ",
                        data.version);
    return std::nullopt;
}

}  // namespace

uint64_t bytes_per_texel(Format format)
{
    switch (format) {
        case Format::r8_uint: return 1;
        case Format::r16_unorm: return 2;
        case Format::r32_uint: return 4;
        case Format::rgba32_uint:
        case Format::rgba32_float: return 16;
        case Format::rgba8_unorm: return 4;
    }
    return 0;
}

const char* name_of(Format format)
{
    switch (format) {
        case Format::r8_uint: return "r8_uint";
        case Format::r16_unorm: return "r16_unorm";
        case Format::r32_uint: return "r32_uint";
        case Format::rgba32_uint: return "rgba32_uint";
        case Format::rgba32_float: return "rgba32_float";
        case Format::rgba8_unorm: return "rgba8_unorm";
    }
    return "?";
}

ResourceDesc buffer_desc(uint64_t bytes)
{
    return {.kind = ResourceDesc::Kind::buffer, .bytes = bytes};
}

ResourceDesc words_desc(const glm::uvec3& words)
{
    return {.kind = ResourceDesc::Kind::buffer,
            .by_address = true,
            .texels = words,
            .bytes = uint64_t(words.x) * words.y * words.z * sizeof(uint32_t)};
}

ResourceDesc image_desc(Format format, const glm::uvec3& texels)
{
    const uint64_t bytes = uint64_t(texels.x) * texels.y * texels.z * bytes_per_texel(format);
    return {.kind = ResourceDesc::Kind::image, .format = format, .texels = texels, .bytes = bytes};
}

ResourceDesc picture_desc(Format format, const glm::uvec2& texels)
{
    ResourceDesc desc = image_desc(format, glm::uvec3(texels, 1));
    desc.is_flat = true;
    return desc;
}

std::string names_of(Stages stages)
{
    std::string names;
    const std::pair<Stages, const char*> all[] = {
        {STAGE_COMPUTE, "compute"}, {STAGE_TRANSFER, "transfer"}, {STAGE_HOST, "host"}};
    for (const auto& [stage, name] : all)
        if (stages & stage) names += (names.empty() ? "" : "+") + std::string(name);
    return names.empty() ? "nothing" : names;
}

void Pass::read(const std::string& name, Resource resource)
{
    use(name, resource, true, false);
}

Resource Pass::write(const std::string& name, Resource resource)
{
    return use(name, resource, false, true);
}

Resource Pass::modify(const std::string& name, Resource resource)
{
    return use(name, resource, true, true);
}

Resource Pass::use(const std::string& name, Resource resource, bool reads, bool writes)
{
    return graph_.use(index_, name, resource, reads, writes);
}

void Pass::constant(const std::string& name, uint32_t value)
{
    graph_.passes_[index_].constants.emplace_back(name, value);
}

void Pass::set_push(std::span<const std::byte> bytes)
{
    graph_.passes_[index_].push.assign(bytes.begin(), bytes.end());
}

void Pass::add_block(const std::string& name, std::span<const std::byte> bytes)
{
    graph_.passes_[index_].blocks.emplace_back(name, std::vector<std::byte>(bytes.begin(), bytes.end()));
}

void Pass::dispatch(const glm::uvec3& threads, const glm::uvec3& tile)
{
    graph_.passes_[index_].threads = threads;
    graph_.passes_[index_].tile = tile;
}

struct FrameGraph::Undo {
    std::vector<std::function<void()>> steps;
    Undo() = default;
    Undo(const Undo&) = delete;
    Undo& operator=(const Undo&) = delete;
    ~Undo()
    {
        for (size_t i = steps.size(); i-- > 0;) steps[i]();
    }
};

void FrameGraph::unless_submitted(std::function<void()> undo)
{
    if (!undo_) undo_ = std::make_shared<Undo>();
    undo_->steps.push_back(std::move(undo));
}

void FrameGraph::note_submitted() const
{
    if (undo_) undo_->steps.clear();
}

Resource FrameGraph::import(const std::string& name, const Import& import)
{
    for (const ResourceData& other : resources_)
        if (other.imported && other.import_id == import.id)
            fail("'", name, "' is imported twice (first as '", other.name, "'); expected one handle per object");
    resources_.push_back(
        {.name = name, .desc = import.desc, .imported = true, .import_id = import.id, .state = import.state});
    return {uint32_t(resources_.size() - 1), 0};
}

Resource FrameGraph::create(const std::string& name, const ResourceDesc& desc)
{
    if (desc.bytes == 0) fail("resource '", name, "' has 0 bytes; expected at least one");
    resources_.push_back({.name = name, .desc = desc});
    return {uint32_t(resources_.size() - 1), 0};
}

Resource FrameGraph::upload_bytes(const std::string& name, std::span<const std::byte> bytes)
{
    const Resource resource = create(name, buffer_desc(bytes.size()));
    // Uploads need no barrier: a queue submission sees all earlier host writes (Vulkan 1.3, 7.9).
    resources_[resource.index].contents.assign(bytes.begin(), bytes.end());
    return resource;
}

PassData& FrameGraph::add(PassData::Kind kind, const std::string& name, Location at)
{
    passes_.push_back({.name = name, .kind = kind, .declared_at = at});
    return passes_.back();
}

Resource FrameGraph::use(uint32_t index, const std::string& name, Resource resource, bool reads, bool writes)
{
    PassData& pass = passes_[index];
    if (const auto fault = fault_of(resource, *this)) fail(place(pass), " binds '", name, "' to ", *fault);
    ResourceData& data = resources_[resource.index];
    if (reads && !data.imported && data.contents.empty() && data.version == 0)
        fail(place(pass), " reads '", data.name, "', which no pass has written");
    for (const Binding& other : pass.bindings) {
        if (other.name == name) fail(place(pass), " binds '", name, "' twice");
        if (other.resource == resource.index && (other.writes || writes))
            fail(place(pass), " binds '", data.name, "' twice, as '", other.name, "' and '", name,
                 "', and writes it; expected one binding");
    }
    pass.bindings.push_back({.name = name, .resource = resource.index, .reads = reads, .writes = writes});
    if (!writes) return resource;
    data.writers.push_back(index);
    return {resource.index, ++data.version};
}

Pass FrameGraph::compute(const std::string& kernel, const std::string& name, Location at)
{
    add(PassData::Kind::compute, name.empty() ? kernel : name, at).kernel = kernel;
    return {*this, uint32_t(passes_.size() - 1)};
}

Pass FrameGraph::compute(const std::string& kernel, std::initializer_list<VariantChoice> choices,
                         const std::string& name, Location at)
{
    PassData& pass = add(PassData::Kind::compute, name.empty() ? kernel : name, at);
    try {
        pass.kernel = variant_of(kernel, choices);
    } catch (const Error& error) {
        fail(place(pass), ": ", error.what());
    }
    return {*this, uint32_t(passes_.size() - 1)};
}

Resource FrameGraph::fill(Resource target, uint32_t value, const std::string& name, Location at)
{
    const ResourceDesc& desc = resources_[target.index].desc;
    SHVR_CHECK(
        desc.kind == ResourceDesc::Kind::buffer || desc.format == Format::r8_uint || desc.format == Format::r32_uint,
        name);
    add(PassData::Kind::fill, name, at).fill_value = value;
    return use(uint32_t(passes_.size() - 1), "target", target, false, true);
}

Resource FrameGraph::copy_to_image(Resource buffer, Resource image, std::vector<ImageRegion> regions,
                                   const std::string& name, Location at)
{
    add(PassData::Kind::copy_to_image, name, at).image_regions = std::move(regions);
    const uint32_t index = uint32_t(passes_.size() - 1);
    use(index, "source", buffer, true, false);
    return use(index, "target", image, false, true);
}

Resource FrameGraph::copy(Resource from, Resource to, std::vector<BufferRegion> regions, const std::string& name,
                          Location at)
{
    add(PassData::Kind::copy_buffer, name, at).buffer_regions = std::move(regions);
    const uint32_t index = uint32_t(passes_.size() - 1);
    use(index, "source", from, true, false);
    return use(index, "target", to, false, true);
}

uint32_t FrameGraph::read_back(Resource resource, const std::string& name, Location at)
{
    const std::string label =
        !name.empty() ? name
                      : "read back " + (resource.index < resources_.size() ? resources_[resource.index].name : "");
    add(PassData::Kind::read_back, label, at).read_back = read_backs_;
    use(uint32_t(passes_.size() - 1), "source", resource, true, false);
    return read_backs_++;
}

void FrameGraph::keep(Resource resource)
{
    if (const auto fault = fault_of(resource, *this)) fail("keep() was given ", *fault);
    resources_[resource.index].kept = true;
}

namespace {

/// Returns, for each pass, whether it is kept. A pass is kept if it has an effect outside the frame, or if a kept pass
/// needs its output. A kept write also keeps the earlier writers of its resource, since it may write only a part.
std::vector<bool> living_passes(const FrameGraph& graph)
{
    const auto& passes = graph.passes();
    const auto& resources = graph.resources();
    std::vector<bool> needed(resources.size());  // whether a kept pass later on uses the resource
    std::vector<bool> alive(passes.size());
    for (size_t r = 0; r < resources.size(); ++r) needed[r] = resources[r].kept;
    for (size_t i = passes.size(); i-- > 0;) {
        const PassData& pass = passes[i];
        alive[i] = pass.kind == PassData::Kind::read_back ||
                   std::any_of(pass.bindings.begin(), pass.bindings.end(), [&](const Binding& binding) {
                       return binding.writes && (resources[binding.resource].imported || needed[binding.resource]);
                   });
        if (!alive[i]) continue;
        for (const Binding& binding : pass.bindings) needed[binding.resource] = true;
    }
    return alive;
}

/// Returns the barrier that `pass` needs before it, given the accesses in flight; null if none.
std::optional<Barrier> barrier_before(const PassData& pass, const std::vector<ResourceState>& states)
{
    Barrier barrier;
    for (const Binding& binding : pass.bindings) {
        const Stages stages = stages_of(pass);
        const ResourceState& state = states[binding.resource];
        if (state.written_by && (stages & ~state.visible_to)) {  // read after write, or write after write
            barrier.from |= state.written_by;
            barrier.to |= stages;
            barrier.memory = true;
        }
        if (binding.writes && state.read_by && (stages & ~state.after_reads)) {  // write after read
            barrier.from |= state.read_by;
            barrier.to |= stages;
        }
    }
    if (barrier.from == 0) return std::nullopt;
    return barrier;
}

/// Updates the states for a barrier. Barriers are global: each covers all resources in its stages.
void settle(const Barrier& barrier, std::vector<ResourceState>& states)
{
    for (ResourceState& state : states) {
        if (barrier.memory && (state.written_by & ~barrier.from) == 0) state.visible_to |= barrier.to;
        if ((state.read_by & ~barrier.from) == 0) state.after_reads |= barrier.to;
    }
}

void record_use(const PassData& pass, std::vector<ResourceState>& states)
{
    for (const Binding& binding : pass.bindings) {
        const Stages stages = stages_of(pass);
        ResourceState& state = states[binding.resource];
        if (binding.writes) {
            state = {.written_by = stages};
            continue;
        }
        // If this read was ordered after all other reads, a barrier that waits for it also waits for the others.
        const bool is_after_all = (stages & ~state.after_reads) == 0;
        state.read_by = is_after_all ? stages : Stages(state.read_by | stages);
        state.after_reads = 0;
    }
}

/// Transient resources that no later pass uses. Equal resources that are first used later can take over their memory.
class FreeMemory {
public:
    FreeMemory(const FrameGraph& graph, const std::vector<bool>& alive)
        : resources_(graph.resources()), last_pass_(resources_.size())
    {
        for (uint32_t i = 0; i < alive.size(); ++i)
            if (alive[i])
                for (const Binding& binding : graph.passes()[i].bindings) last_pass_[binding.resource] = i;
    }
    /// Removes and returns a resource whose memory `wanted` may reuse.
    std::optional<uint32_t> take(uint32_t wanted)
    {
        const auto found = std::find_if(free_.begin(), free_.end(), [&](uint32_t one) {
            return is_shared(wanted) && resources_[one].desc == resources_[wanted].desc;
        });
        if (found == free_.end()) return std::nullopt;
        const uint32_t taken = *found;
        free_.erase(found);
        return taken;
    }
    void note_end_of(uint32_t pass, const std::vector<Binding>& bindings)
    {
        for (const Binding& binding : bindings) {
            uint32_t& last = last_pass_[binding.resource];
            if (!is_shared(binding.resource) || last != pass) continue;
            free_.push_back(binding.resource);
            last = NEVER;  // freed only once, even if a pass reads the resource under two names
        }
    }

private:
    /// Whether the memory may be shared. Excludes imports, and buffers that the host fills before the first pass.
    bool is_shared(uint32_t resource) const
    {
        return !resources_[resource].imported && resources_[resource].contents.empty();
    }
    static constexpr uint32_t NEVER = ~0u;
    const std::vector<FrameGraph::ResourceData>& resources_;
    std::vector<uint32_t> last_pass_;  // the last pass that uses each resource
    std::vector<uint32_t> free_;
};

}  // namespace

CompiledGraph FrameGraph::compile() const
{
    const std::vector<bool> alive = living_passes(*this);
    FreeMemory free_memory(*this, alive);
    CompiledGraph compiled;
    compiled.used.resize(resources_.size());
    std::vector<ResourceState>& states = compiled.final_states;
    for (const ResourceData& resource : resources_) {
        compiled.memory_of.push_back(uint32_t(states.size()));
        states.push_back(resource.state);
    }
    const auto begin_use = [&](uint32_t resource) {
        if (compiled.used[resource]) return;
        compiled.used[resource] = true;
        const std::optional<uint32_t> before = free_memory.take(resource);
        if (!before) return;
        compiled.memory_of[resource] = compiled.memory_of[*before];
        states[resource] = states[*before];  // the first use, a write, then waits for the last uses of `before`
    };

    for (uint32_t i = 0; i < passes_.size(); ++i) {
        const PassData& pass = passes_[i];
        if (!alive[i]) continue;
        if (pass.kind == PassData::Kind::compute && glm::any(glm::equal(pass.threads, glm::uvec3(0))))
            fail(place(pass), " dispatches ", pass.threads.x, " x ", pass.threads.y, " x ", pass.threads.z,
                 " threads; expected at least one");
        for (const Binding& binding : pass.bindings) begin_use(binding.resource);
        const std::optional<Barrier> barrier = barrier_before(pass, states);
        if (barrier) settle(*barrier, states);
        record_use(pass, states);
        free_memory.note_end_of(i, pass.bindings);
        compiled.steps.push_back({i, barrier});
    }
    return compiled;
}

}  // namespace shvr
