#pragma once
// Owns the device, its memory, the executor of graphs and the loaded scene. Makes whole pictures; see frame.h for the
// passes, picture_job.h for the parts, and engine/live/view.h for interactive pictures.
//
// One thread, the one that owns the device.

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "engine/base/image.h"
#include "engine/device/scene_estimate.h"
#include "engine/picture/frame.h"

namespace shvr {

/// Any call of Renderer may throw DeviceLost; afterwards, only restart() may be called.
using gpu::DeviceLost;

struct RenderOptions {
    std::optional<ProbeLook> probe;
    bool outlines_probe = false;  ///< outlines the probe even where it is hidden; draws an arrow if it is out of sight
    bool count_work = false;      ///< keeps the exact work counters (a little slower)
    bool serialize = false;       ///< a full barrier between passes
    bool timestamps = true;
    bool statistics = false;  ///< counts kernel invocations, if the device supports it
    /// Maximum side, in pixels, of the parts drawn one at a time. If memory is short, parts are smaller.
    uint32_t part_pixels = 1024;
    Progress progress{};
};

struct Picture {
    ImageF image;          ///< linear light, premultiplied, over the background
    bool complete = true;  ///< every visited brick was loaded at the wanted level, and every feature had memory
    std::vector<std::string> warnings;  ///< what the picture lacks
    std::vector<gpu::PassReport> passes;
    double wall_ms = 0.0;
    FrameGraph graph;  ///< the graph that ran, for `profile --graph`
};

class Renderer {
public:
    struct Options {
        gpu::DeviceOptions device;
        /// Memory limits. Half of the host bytes (0: 2 GiB) are for mapped memory, a quarter for bricks cached on the
        /// host, and a quarter for coarser levels, which are made in memory for files without levels.
        gpu::Budget budget;
        int threads = 0;  ///< worker threads that build bricks; 0: one per core
    };
    explicit Renderer(const Options& options);

    gpu::Device& device() { return on_device_->device; }
    gpu::Memory& memory() { return on_device_->memory; }
    gpu::Executor& executor() { return on_device_->executor; }
    /// Re-creates a lost device, without a scene. All objects of the old device must have been released: storages,
    /// submissions and the window's objects. On failure there is no device: try again, or terminate.
    void restart();
    /// Returns the host's part of the memory budget, in bytes.
    uint64_t host_budget() const { return host_budget_; }
    /// Returns the host bytes in use: mapped memory, bricks cached on the host, and the picture being rendered.
    uint64_t host_bytes() const;
    uint64_t peak_host_bytes() const;
    /// Notes how many host bytes the picture being rendered takes, for host_bytes().
    void note_picture_bytes(uint64_t bytes);

    /// Replaces the scene by a scene of this volume. The `settings` for sampling and paging decide how the device
    /// stores the bricks. `with_occlusion`: reserves memory for ambient occlusion. On failure the previous scene stays
    /// if memory has room for both scenes; if not, the previous scene was destroyed first, and no scene is loaded.
    void load(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
              const RenderSettings& settings = {}, bool with_occlusion = false, const Progress& progress = {});
    /// Starts loading a scene in time slices, for a loop that must keep running: as a second scene if fits_beside() is
    /// true, otherwise as the only scene, after take_scene(). Once the scene's load_on() is done, call show().
    /// `document`: the annotation to show. Coarser levels (with_levels) are made here if the source lacks them.
    std::unique_ptr<Scene> begin_loading(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
                                         const RenderSettings& settings, bool with_occlusion, const Document& document);
    bool fits_beside(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion,
                     const Document& document);
    /// Returns the source. If it would be paged and lacks coarser levels, makes levels by reading it once. Any thread.
    /// `reserved_bytes`: device memory for the annotation (Scene::bytes_to_show).
    std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source,
                                                    const RenderSettings& settings, bool with_occlusion,
                                                    uint64_t reserved_bytes = 0, const Progress& progress = {}) const;
    /// Returns the memory needed to load the source while nothing else is loaded. Reads no voxels. Any thread.
    SceneEstimate estimate(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion) const;
    /// Removes the scene and returns it; null if there was none.
    std::unique_ptr<Scene> take_scene() { return std::move(scene_); }
    std::unique_ptr<Scene> show(std::unique_ptr<Scene> scene) { return std::exchange(scene_, std::move(scene)); }
    /// Fails if load() is certain to fail because of the volume's size. Reads no voxels.
    void check_sizes(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion);
    Scene& scene() const;
    DeviceVolume& volume() const { return scene().volume(); }
    const VolumeStatistics& statistics() const { return scene().statistics(); }

    /// Draws `session` (its look and its panes) from `camera`. Waits for the device. Fails if the picture exceeds the
    /// host's budget.
    Picture render(const Session& session, const Camera& camera, const RenderOptions& options = {});
    /// Returns the point visible at a pixel. Samples along the pixel's ray form runs: a run ends where opacity has
    /// fallen to a quarter of its maximum in the run and then doubles. The point lies in the run that contributes most
    /// to the ray's opacity, at the sample of this run that contributes most (after Wiebel et al. 2012, "WYSIWYP: What
    /// You See Is What You Pick"). A surface that ends the ray is a run of its own. Null if no run contributes enough
    /// to be visible (PICK in shaders/raycast.h). `probe`: drawn as in the picture. Waits for the device.
    struct Seen {
        glm::dvec3 point{0.0};  ///< volume space
        double opacity = 0.0;   ///< total opacity of the ray
    };
    std::optional<Seen> pick(const Look& look, const Camera& camera, const glm::uvec2& pixels, const glm::uvec2& pixel,
                             const std::optional<ProbeLook>& probe = {});

private:
    Scene::Options scene_options(const RenderSettings& settings, bool with_occlusion) const;

    struct OnDevice {
        gpu::Device device;
        gpu::Memory memory;
        gpu::Executor executor;
        OnDevice(const gpu::DeviceOptions& options, const gpu::Budget& budget)
            : device(options), memory(device, budget), executor(device, memory)
        {}
    };

    gpu::DeviceOptions device_options_;
    uint64_t device_budget_, host_budget_;
    int threads_;
    mutable std::mutex device_mutex_;  ///< guards on_device_: with_levels() runs on a worker, even during restart(),
                                       ///< which re-creates the device
    std::unique_ptr<OnDevice> on_device_;
    uint64_t picture_bytes_ = 0, peak_picture_bytes_ = 0;
    std::unique_ptr<Scene> scene_;
};

}  // namespace shvr
