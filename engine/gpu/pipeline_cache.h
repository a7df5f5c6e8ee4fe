#pragma once
// Keeps compiled pipelines in a file between runs of the program: the driver's own cache data, and the list of kernels
// in use, which the next run is likely to need again.
//
// There is one file per device, in $XDG_CACHE_HOME/shvr or ~/.cache/shvr, written atomically. A file that is damaged,
// belongs to another driver or has grown beyond MAX_BYTES is ignored and replaced. No function here fails: without a
// usable file, all kernels are compiled again.

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

/// The contents of a file.
struct KeptPipelines {
    std::vector<KernelVariant> likely;  ///< most recently used first
    std::vector<std::byte> data;        ///< the driver's own cache data
    bool operator==(const KeptPipelines&) const = default;
};
/// `driver`: a string that identifies the driver and device uniquely.
std::vector<std::byte> encode(const KeptPipelines& kept, const std::string& driver);
/// Returns null if the bytes are damaged or were written by another driver.
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

    /// The cache for creating pipelines on any thread; null if the driver lacks the memory for a cache.
    VkPipelineCache handle() const { return handle_; }
    const std::vector<KernelVariant>& likely() const { return kept_.likely; }

    /// Counts a new pipeline. `was_cached`: the driver found the pipeline in the cache. Any thread.
    void note_made(bool was_cached) { (was_cached ? cached_ : compiled_)++; }
    uint64_t compiled() const { return compiled_; }
    uint64_t cached() const { return cached_; }

    /// Writes the file if it would contain more than the file that was read: if a pipeline was compiled, or if `used`
    /// has kernels that were not listed as likely.
    void save(const std::set<KernelVariant>& used) noexcept;

private:
    std::vector<std::byte> data_of_driver() const;

    Device& device_;
    std::string driver_;
    std::filesystem::path file_;  ///< empty: no file is used
    KeptPipelines kept_;
    VkPipelineCache handle_ = VK_NULL_HANDLE;
    std::atomic<uint64_t> compiled_ = 0, cached_ = 0;
};

}  // namespace shvr::gpu
