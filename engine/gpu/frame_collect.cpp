// Submits a graph, detects its completion, and collects its results (frame_in_flight.h).

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <utility>

#include "engine/gpu/frame_in_flight.h"
#include "engine/gpu/live_trace.h"

namespace shvr::gpu {

namespace {

void add_counters(PassReport& report, std::span<const std::byte> rows)
{
    report.counters.assign(COUNTERS, 0);
    for (; !rows.empty(); rows = rows.subspan(COUNTER_ROW_BYTES)) {
        std::array<uint64_t, COUNTERS> row;
        std::memcpy(row.data(), rows.data(), COUNTER_ROW_BYTES);
        report.counted_rows += std::ranges::any_of(row, [](uint64_t value) { return value != 0; });
        for (size_t i = 0; i < COUNTERS; ++i) report.counters[i] += row[i];
    }
}

}  // namespace

void Submission::Frame::submit()
{
    const TraceSpan span("submit");
    Device& device = executor.device_;
    started = std::chrono::steady_clock::now();
    for (size_t i = 0; i < chunks.size(); ++i) {
        const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                                 .commandBuffer = chunks[i]};
        const VkSubmitInfo2 info{
            .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &commands};
        const bool last = i + 1 == chunks.size();
        const VkResult result = vkQueueSubmit2(device.queue(), 1, &info, last ? objects->fence() : VK_NULL_HANDLE);
        if (result < 0) {
            device.wait_idle_or_lost();
            if (i > 0) note_unknown_states();
            device.check(result, "vkQueueSubmit2");
        }
        if (i == 0)
            for (Memory::Object* image : transitioned) image->in_general_layout = true;
    }
    number = device.note_submission();
    // Barriers are global, so they also affect imported resources that no remaining pass uses.
    for (uint32_t i = 0; i < compiled.final_states.size(); ++i)
        if (compiled.used[i] || graph.resources()[i].imported) object(i).state = compiled.final_states[i];
}

/// Marks the states as unknown, because an unknown part of the frame has run.
void Submission::Frame::note_unknown_states() const
{
    for (uint32_t i = 0; i < compiled.used.size(); ++i)
        if (compiled.used[i]) object(i).state = UNKNOWN_STATE;
}

bool Submission::Frame::done() const
{
    if (number == 0 || number <= executor.device_.done()) return true;
    // Returns the fence's status like vkGetFenceStatus, in a way that shows the validation layer that the host waited.
    const VkFence fence = objects->fence();
    const VkResult result = vkWaitForFences(executor.device_.handle(), 1, &fence, VK_TRUE, 0);
    executor.device_.check(result, "vkWaitForFences");
    if (result == VK_SUCCESS) executor.device_.note_done(number);
    return result == VK_SUCCESS;
}

void Submission::Frame::wait() const
{
    if (number == 0) return;
    const TraceSpan span("wait for the device");
    const VkFence fence = objects->fence();
    executor.device_.check(vkWaitForFences(executor.device_.handle(), 1, &fence, VK_TRUE, UINT64_MAX),
                           "vkWaitForFences");
    executor.device_.note_done(number);
}

std::vector<std::vector<std::byte>> Submission::Frame::copy_read_backs() const
{
    std::vector<std::vector<std::byte>> copies(read_backs.size());
    for (const Step& step : compiled.steps) {
        const PassData& data = pass(step);
        if (data.kind != PassData::Kind::read_back) continue;
        const uint64_t size = graph.resources()[data.bindings[0].resource].desc.bytes;
        const std::span<const std::byte> bytes = read_backs[data.read_back]->mapped().first(size);
        copies[data.read_back].assign(bytes.begin(), bytes.end());
    }
    return copies;
}

FrameResult Submission::Frame::collect()
{
    if (number == 0) return {};  // no step, nothing submitted
    wait();
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - started;
    FrameResult result{.wall_ms = wall.count()};
    result.read_backs = copy_read_backs();
    const DeviceTraits& traits = executor.device_.traits();
    std::vector<uint64_t> ticks(compiled.steps.size() * 2);
    const auto results_of = [&](VkQueryPool queries, std::vector<uint64_t>& results) {
        executor.device_.check(vkGetQueryPoolResults(executor.device_.handle(), queries, 0, uint32_t(results.size()),
                                                     results.size() * sizeof(uint64_t), results.data(),
                                                     sizeof(uint64_t), VK_QUERY_RESULT_64_BIT),
                               "vkGetQueryPoolResults");
    };
    if (is_timed) results_of(objects->queries(), ticks);
    std::vector<uint64_t> invocations(counted_steps.size());
    if (!counted_steps.empty()) results_of(objects->statistics(), invocations);
    const uint64_t mask = traits.timestamp_bits >= 64 ? ~uint64_t(0) : (uint64_t(1) << traits.timestamp_bits) - 1;
    const auto milliseconds = [&](uint64_t from, uint64_t to) {
        return double((to - from) & mask) * double(traits.nanoseconds_per_tick) * 1e-6;
    };
    if (is_timed) result.gpu_ms = milliseconds(ticks.front(), ticks.back());
    if constexpr (IS_TRACED) {
        std::vector<TracedPass> traced;
        for (size_t i = 0; is_timed && i < compiled.steps.size(); ++i)
            traced.push_back({pass(compiled.steps[i]).name, ticks[2 * i], ticks[2 * i + 1]});
        trace_passes({reinterpret_cast<uint64_t>(executor.device_.handle()), double(traits.nanoseconds_per_tick), mask},
                     traced);
    }
    for (size_t i = 0; i < compiled.steps.size(); ++i) {
        const PassData& data = pass(compiled.steps[i]);
        PassReport report{.name = data.name, .kernel = data.kernel};
        report.dispatches = prepared[i].dispatches;
        report.tiles = prepared[i].tiles;
        report.submissions = prepared[i].submissions;
        report.recorded = prepared[i].recorded;
        report.record_ms = std::chrono::duration<double, std::milli>(prepared[i].recording).count();
        if (is_timed) {
            report.timed = true;
            report.start_ms = milliseconds(ticks[0], ticks[2 * i]);
            report.gpu_ms = milliseconds(ticks[2 * i], ticks[2 * i + 1]);
        }
        for (size_t query = 0; query < counted_steps.size() && !prepared[i].is_counted_in_part; ++query)
            if (counted_steps[query] == i) report.invocations = report.invocations.value_or(0) + invocations[query];
        // On a device without timestamps, the host time of all passes up to a pass bounds the time of that pass. With
        // timestamps, an untimed frame gives no estimate, since its host time may include long waits in the queue.
        if (prepared[i].kernel && (is_timed || traits.timestamp_bits == 0))
            executor.costs_.learn(data.kernel, threads_of(data, *prepared[i].kernel),
                                  is_timed ? report.gpu_ms : result.wall_ms);
        for (const Binding& binding : data.bindings) report.bytes += graph.resources()[binding.resource].desc.bytes;
        if (const auto& barrier = compiled.steps[i].barrier)
            report.barrier = names_of(barrier->from) + " -> " + names_of(barrier->to);
        if (prepared[i].kernel && prepared[i].kernel->interface().slot("counters")) {
            add_counters(report, counters->mapped().subspan(prepared[i].counters_offset, counter_bytes));
        }
        result.passes.push_back(std::move(report));
    }
    return result;
}

}  // namespace shvr::gpu
