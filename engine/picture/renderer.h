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

/// Any call here may fail so; then restart() is all that helps.
using gpu::DeviceLost;

struct RenderOptions {
    std::optional<ProbeLook> probe;
    bool outlines_probe = false;  ///< draws its outline over what hides it, or an arrow where it is out of sight
    bool count_work = false;      ///< keep the exact work counters (a little slower)
    bool serialize = false;       ///< a full barrier between passes
    bool timestamps = true;
    bool statistics = false;  ///< count invocations of kernels, where the device can
    /// Side in pixels of the parts that are drawn one at a time, at most: smaller where memory is short.
    uint32_t part_pixels = 1024;
    Progress progress{};
};

struct Picture {
    ImageF image;          ///< linear light, premultiplied, over the background
    bool complete = true;  ///< every visited brick was loaded, as fine as wanted, and every feature had room
    std::vector<std::string> warnings;  ///< what was missing
    std::vector<gpu::PassReport> passes;
    double wall_ms = 0.0;
    FrameGraph graph;  ///< what was run, for `profile --graph`
};

class Renderer {
public:
    struct Options {
        gpu::DeviceOptions device;
        /// Half of the host's bytes (0: 2 GiB) are for mapped memory, a quarter for bricks kept on the host and a
        /// quarter for coarser levels of files without any.
        gpu::Budget budget;
        int threads = 0;  ///< workers that build bricks; 0: one per core
    };
    explicit Renderer(const Options& options);

    gpu::Device& device() { return on_device_->device; }
    gpu::Memory& memory() { return on_device_->memory; }
    gpu::Executor& executor() { return on_device_->executor; }
    /// Makes a lost device anew, without a scene. Nothing that was on the old one may be held any more: storages,
    /// submissions, the window's. Where it fails there is no device: try again, or end.
    void restart();
    /// The host's part of the budget, in bytes.
    uint64_t host_budget() const { return host_budget_; }
    /// Host bytes in use: mapped memory, bricks kept on the host, and a picture that is being made.
    uint64_t host_bytes() const;
    uint64_t peak_host_bytes() const;
    /// What the picture that is being made takes now, for these accounts.
    void note_picture_bytes(uint64_t bytes);

    /// Replaces the scene by one of this volume. The `settings` for sampling and paging decide how the device holds the
    /// bricks. `with_occlusion`: reserves room for ambient occlusion. On failure the previous scene stays if both fit
    /// in memory together; otherwise it was destroyed first, and there is none.
    void load(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
              const RenderSettings& settings = {}, bool with_occlusion = false, const Progress& progress = {});
    /// The same in slices, for a loop that goes on meanwhile: begins with a scene beside the present one, where
    /// fits_beside() holds, or after take_scene(); once its load_on() is done it is shown. `document`: what it will
    /// show. A source should have its levels (with_levels), or they are made here.
    std::unique_ptr<Scene> begin_loading(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
                                         const RenderSettings& settings, bool with_occlusion, const Document& document);
    bool fits_beside(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion);
    /// The source, with coarser levels where it would be paged and has too few: reads it once. Any thread.
    std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source,
                                                    const RenderSettings& settings, bool with_occlusion,
                                                    const Progress& progress = {}) const;
    /// What loading it would take, with nothing else loaded. Reads no voxels. Any thread.
    SceneEstimate estimate(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion) const;
    /// Takes the scene away, or puts one in its place, and returns the one there was; null: none.
    std::unique_ptr<Scene> take_scene() { return std::move(scene_); }
    std::unique_ptr<Scene> show(std::unique_ptr<Scene> scene) { return std::exchange(scene_, std::move(scene)); }
    /// Fails where the sizes alone tell that load() would; reads no voxels.
    void check_sizes(const VolumeSource& source, const RenderSettings& settings, bool with_occlusion);
    bool has_scene() const { return scene_ != nullptr; }
    Scene& scene() const;
    DeviceVolume& volume() const { return scene().volume(); }
    const VolumeStatistics& statistics() const { return scene().statistics(); }

    /// Draws `session` (its look and its panes) from `camera`. Waits for the device. Fails where the host's budget
    /// cannot hold the picture.
    Picture render(const Session& session, const Camera& camera, const RenderOptions& options = {});
    /// What is seen at a pixel. Samples along its ray make runs: one ends where their opacity has fallen to a quarter
    /// of its largest in the run and then doubles. The point lies in the run that adds most to the ray's opacity, at
    /// the sample that adds most (after Wiebel et al. 2012, "WYSIWYP: What You See Is What You Pick"); a surface that
    /// ends the ray is a run of its own. Null where no run adds gpu::LEAST_SEEN. `probe`: drawn as in the picture.
    /// Waits for the device.
    struct Seen {
        glm::dvec3 point{0.0};  ///< volume space
        double opacity = 0.0;   ///< of the whole ray
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
    mutable std::mutex device_mutex_;  ///< of the next: a worker asks (with_levels) while restart() makes it anew
    std::unique_ptr<OnDevice> on_device_;
    uint64_t picture_bytes_ = 0, peak_picture_bytes_ = 0;
    std::unique_ptr<Scene> scene_;
};

}  // namespace shvr
