#include "engine/gpu/executor.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/gpu/frame_in_flight.h"

namespace shvr::gpu {

namespace {

/// Rounds up to one of two sizes per power of two. A brush's upload boxes vary by one voxel per side; with rounding, an
/// upload can reuse the buffer of the previous one.
uint64_t rounded(uint64_t bytes)
{
    constexpr uint64_t LEAST = 1024;
    const uint64_t power = std::bit_ceil(std::max(bytes, LEAST));
    return bytes <= power / 4 * 3 ? power / 4 * 3 : power;
}

}  // namespace

Executor::Executor(Device& device, Memory& memory) : device_(device), memory_(memory), kernels_(device)
{
    const VkSamplerCreateInfo sampler{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                      .magFilter = VK_FILTER_LINEAR,
                                      .minFilter = VK_FILTER_LINEAR,
                                      .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                      .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    SHVR_VK(vkCreateSampler(device.handle(), &sampler, nullptr, &sampler_));
    device.set_name(VK_OBJECT_TYPE_SAMPLER, reinterpret_cast<uint64_t>(sampler_), "linear clamp");
    memory.free_idle_by([this] { trim(); });
}

Executor::~Executor()
{
    memory_.free_idle_by({});
    device_.wait_idle_or_lost();
    vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Storage& Executor::take_transient(const std::string& name, const ResourceDesc& wanted, Placement placement,
                                  bool is_counted_in)
{
    ResourceDesc desc = wanted;
    if (placement != Placement::device) desc.bytes = rounded(desc.bytes);
    // Takes the least recently used suitable buffer. So all buffers needed at peak load stay in use, instead of being
    // freed and created again.
    Transient* found = nullptr;
    for (const auto& transient : transients_) {
        if (transient->taken || transient->placement != placement || !(transient->desc == desc)) continue;
        // Counters of kernels never reuse a buffer written by a copy. The validation layer (1.3.239) sometimes misses
        // that the host waited for the copy's frame, and would then report a read-after-write hazard.
        if (transient->is_counted_in != is_counted_in) continue;
        if (!found || transient->last_run < found->last_run) found = transient.get();
    }
    if (found) {
        found->taken = true;
        found->last_run = runs_;
        return found->storage;
    }
    transients_.push_back(std::make_unique<Transient>(
        Transient{desc, placement, runs_, true, is_counted_in, memory_.create(name, desc, placement)}));
    return transients_.back()->storage;
}

void Executor::trim(uint64_t runs)
{
    std::erase_if(transients_, [&](const auto& t) {
        if (t->taken || t->last_run + runs > runs_) return false;
        t->storage.reset_idle();  // not in use on the device: the frame that last used it is done
        return true;
    });
}

Submission Executor::submit(FrameGraph graph, const Options& options)
{
    constexpr uint64_t RUNS_KEPT = 512;  // buffers unused for longer than this are freed
    ++runs_;
    trim(RUNS_KEPT);
    auto frame = std::make_unique<Submission::Frame>(*this, std::move(graph), options);
    if (!frame->compiled.steps.empty()) {
        frame->prepare();
        frame->record();
        frame->submit();
    }
    frame->graph.note_submitted();
    kernels_.expect(frame->graph.expected());
    return Submission(std::move(frame));
}

Submission::Submission() = default;
Submission::~Submission() = default;
Submission::Submission(Submission&&) noexcept = default;
Submission& Submission::operator=(Submission&&) noexcept = default;
Submission::Submission(std::unique_ptr<Frame> frame) : frame_(std::move(frame)) {}

bool Submission::done() const
{
    SHVR_CHECK(frame_ != nullptr);
    return frame_->done();
}

void Submission::wait() const
{
    SHVR_CHECK(frame_ != nullptr);
    frame_->wait();
}

FrameResult Submission::finish()
{
    SHVR_CHECK(frame_ != nullptr);
    FrameResult result = frame_->collect();
    frame_.reset();
    return result;
}

const FrameGraph& Submission::graph() const
{
    SHVR_CHECK(frame_ != nullptr);
    return frame_->graph;
}

}  // namespace shvr::gpu
