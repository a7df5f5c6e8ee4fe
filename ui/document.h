#pragma once
// What is open in the application: session, volume, mask and history, and how they are looked at and touched. Main thread.

#include <filesystem>
#include <memory>

#include "engine/annotation/trace/trace_command.h"
#include "engine/live/previewer.h"
#include "engine/live/screen.h"
#include "engine/picture/picture_job.h"
#include "engine/session/session.h"
#include "ui/action.h"
#include "ui/touch.h"

namespace shvr::ui {

struct Document {
    std::filesystem::path session_path;  ///< where the session is saved
    Session session;
    std::shared_ptr<const VolumeSource> source;
    VolumeStatistics statistics;
    Camera camera;
    PaintOp brush;  ///< but for its path
    double haptic_threshold = 0.0;
    bool assistance = false;
    ProxyLaw law = ProxyLaw::potential;
    Annotator annotator;
    Previewer previewer{annotator};
    Screen screen;
    Touch touch;
    std::vector<SurfaceLook> surfaces;  ///< the session's; taken out of it, since views copy that at every turn
    std::vector<std::string> messages;  ///< what opening the work found
    bool is_saved = true;               ///< the session; work says it of itself
    Tool tool = Tool::paint;
    bool drags_node = false;  ///< the selected one goes with the probe

    bool work_is_saved() const { return annotator.work().unsaved() == 0; }

    /// Loads the volume and, where there is one, the mask onto the device.
    /// `device`: what moves the probe; null for the mouse.
    Document(Renderer& renderer, OpenedSession opened, const std::filesystem::path& input,
             std::unique_ptr<HapticDevice> device, const std::string& device_name, const View::Options& view_options);

    const VolumeInfo& volume() const { return source->info(); }
    glm::dvec3 probe_voxel() const { return touch.probe() / volume().spacing; }
    double probe_radius() const { return brush.radius_voxels * volume().spacing.x; }
    ProbeLook probe_look() const;
    /// The brush as it would paint now, where the probe is.
    PaintOp dab() const;
    /// The node that a person would select or link with: the nearest within reach that is not selected.
    std::optional<uint32_t> nearby_node() const;
    TraceMarks trace_marks() const;
    TraceDefaults trace_defaults() const;
    /// The probe's ball, of at least one voxel of the volume.
    VoxelBox voxels_around_probe() const;
    /// The session as it would be saved: with the camera, the probe and the thresholds of the moment.
    Session saved_session() const;
    /// Writes the mask, offsets and the trace, then the session; each file appears whole or not at all.
    void save();
    std::vector<std::string> cameras() const;

private:
    void name_trace();
};

}  // namespace shvr::ui
