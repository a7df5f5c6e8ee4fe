#pragma once
// Owns the device, its memory and the executor of graphs, and the scene that is loaded. Makes whole pictures; frame.h
// is what they are made of, picture_job.h how, and engine/live/view.h makes them while a person looks.
//
// One thread, the one that owns the device.

#include <memory>
#include <optional>

#include "engine/base/image.h"
#include "engine/picture/frame.h"

namespace shvr {

struct RenderOptions {
    std::optional<ProbeLook> probe;
    bool outlines_probe = false;  ///< through what hides it; an arrow where it is out of sight
    bool count_work = false;      ///< keep the exact work counters (a little slower)
    bool serialize = false;       ///< a full barrier between passes
    bool timestamps = true;
    /// Pixels a side of what is drawn at a time: it bounds what a picture of any size takes of the device.
    uint32_t part_pixels = 1024;
};

struct Picture {
    ImageF image;          ///< linear light, premultiplied, over the background
    bool complete = true;  ///< every brick that rays visited was there, as fine as wanted, and every feature had room
    std::vector<std::string> warnings;  ///< what was not
    std::vector<gpu::PassReport> passes;
    double wall_ms = 0.0;
    FrameGraph graph;  ///< what was run, for `profile --graph`
};

class Renderer {
public:
    struct Options {
        gpu::DeviceOptions device;
        /// Of the host's bytes (0: 2 GiB) half are for mapped memory, a quarter for bricks kept on the host and a
        /// quarter for the coarser levels of files that have none.
        gpu::Budget budget;
        int threads = 0;  ///< workers that build bricks; 0: one a core
    };
    explicit Renderer(const Options& options);

    gpu::Device& device() { return device_; }
    gpu::Memory& memory() { return memory_; }
    gpu::Executor& executor() { return executor_; }
    /// The host's part of the budget.
    uint64_t host_budget() const { return host_budget_; }
    /// Mapped memory, and bricks kept on the host.
    uint64_t host_bytes() const;
    uint64_t peak_host_bytes() const;

    /// Makes a scene of a volume, in place of the one before. Of `settings` sampling and paging decide how the device
    /// holds the bricks. `with_occlusion`: they leave room for ambient occlusion. Where this fails the scene before
    /// stays if both find room beside each other; otherwise it had to go first, and there is none.
    void load(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
              const RenderSettings& settings = {}, bool with_occlusion = false);
    bool has_scene() const { return scene_ != nullptr; }
    Scene& scene() const;
    DeviceVolume& volume() const { return scene().volume(); }
    const VolumeStatistics& statistics() const { return scene().statistics(); }

    /// The picture of `session` (its look and its panes) from `camera`. Waits for it.
    Picture render(const Session& session, const Camera& camera, const RenderOptions& options = {});
    /// What is seen at a pixel: where its ray becomes half opaque, in volume space. `probe`: as it is shown beside it.
    /// Waits for the device.
    std::optional<glm::dvec3> pick(const Look& look, const Camera& camera, const glm::uvec2& pixels,
                                   const glm::uvec2& pixel, const std::optional<ProbeLook>& probe = {});

private:
    gpu::Device device_;
    uint64_t host_budget_;
    gpu::Memory memory_;
    gpu::Executor executor_;
    int threads_;
    std::unique_ptr<Scene> scene_;
};

}  // namespace shvr
