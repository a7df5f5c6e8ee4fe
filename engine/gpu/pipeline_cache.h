#pragma once
// What the driver compiled, kept in a file from one start of the program to the next: the driver's own data, and the
// kernels that were in use, which are likely to be again.
//
// There is one file for each device, in $XDG_CACHE_HOME/shvr or ~/.cache/shvr, written whole or not at all. One that is
// damaged, or that another driver wrote, counts as none and is replaced; so does one that has grown beyond MAX_BYTES.
// Nothing here ever fails: without a file all is compiled anew.

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/graph/kernel_variants.h"

namespace shvr::gpu {

/// What a file holds.
struct KeptPipelines {
    std::vector<KernelVariant> likely;  ///< the ones that came last first
    std::vector<std::byte> data;        ///< the driver's
    bool operator==(const KeptPipelines&) const = default;
};
/// `driver`: whatever tells it from all others.
std::vector<std::byte> encode(const KeptPipelines& kept, const std::string& driver);
/// Null where the bytes are damaged, or another driver's.
std::optional<KeptPipelines> decode(std::span<const std::byte> bytes, const std::string& driver);

class PipelineCache {
public:
    static constexpr int64_t MAX_BYTES = int64_t{64} << 20;
    static constexpr size_t MAX_LIKELY = 64;

    /// Reads the device's file, if there is one.
    explicit PipelineCache(Device& device);
    ~PipelineCache();
    PipelineCache(const PipelineCache&) = delete;
    PipelineCache& operator=(const PipelineCache&) = delete;

    /// For creating pipelines with, on any thread; null where the driver has no memory for it.
    VkPipelineCache handle() const { return handle_; }
    const std::vector<KernelVariant>& likely() const { return kept_.likely; }

    /// A pipeline was made; `was_cached`: of what the driver had compiled before. Any thread.
    void note_made(bool was_cached) { (was_cached ? cached_ : compiled_)++; }
    uint64_t compiled() const { return compiled_; }
    uint64_t cached() const { return cached_; }

    /// Writes the file, if it would tell more than the one that was read: something was compiled, or `used` has kernels
    /// that were not likely.
    void save(const std::set<KernelVariant>& used) noexcept;

private:
    std::vector<std::byte> data_of_driver() const;

    Device& device_;
    std::string driver_;
    std::filesystem::path file_;  ///< empty: nowhere
    KeptPipelines kept_;
    VkPipelineCache handle_ = VK_NULL_HANDLE;
    std::atomic<uint64_t> compiled_ = 0, cached_ = 0;
};

}  // namespace shvr::gpu
