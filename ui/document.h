#pragma once
// What is open in the application: session, volume, mask and history, and how they are looked at and touched. Main
// thread.
//
// Whether it is saved is found out, not kept: the session as it would be saved is compared with the one that was read
// or written last. The camera and the probe's place are left out of that, since they change whenever somebody looks.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "engine/annotation/trace/trace_command.h"
#include "engine/live/previewer.h"
#include "engine/live/screen.h"
#include "engine/picture/picture_job.h"
#include "engine/session/session.h"
#include "ui/action.h"
#include "ui/touch.h"

namespace shvr::ui {

struct Document {
    /// Loads the volume onto the device, then the work that is kept of it. `overridden`: the session is not as its file
    /// says. Fails where either cannot be had; then the device holds no volume. The mouse moves the probe.
    static std::unique_ptr<Document> open(Renderer& renderer, OpenedSession opened, const std::filesystem::path& input,
                                          const View::Options& view_options, bool overridden = false);
    Document(const Document&) = delete;

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
    Tool tool = Tool::paint;
    bool drags_node = false;  ///< the selected one goes with the probe

    /// Brings everything to the device again, which held something else meanwhile. Fails as load and create do.
    void show_again(Renderer& renderer);

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
    /// Closing would lose nothing of work and session, but perhaps where it was looked at from.
    bool is_saved() const { return work_is_saved() && edits_are_saved(); }
    bool work_is_saved() const { return annotator.work().unsaved() == 0; }
    /// To be called after whatever may have changed the session, camera and probe's place apart: what is_saved() found
    /// out is forgotten.
    void note_edit() { edits_are_saved_.reset(); }
    /// Writes the mask, offsets and the trace, then the session; each file appears whole or not at all.
    void save();
    /// Writes the session where it is saved but for the camera and the probe's place, and has a file; otherwise
    /// nothing. So people who only look at a volume leave no file. A file that cannot be written stays as it is.
    void keep_view() const;
    std::vector<std::string> cameras() const;

private:
    Document(Renderer& renderer, OpenedSession opened, const std::filesystem::path& path,
             const View::Options& view_options, bool overridden);
    void load_work(Renderer& renderer);
    void name_trace();
    void write_session() const;
    bool edits_are_saved() const;
    Session edits() const;
    void note_saved();

    bool overridden_;      ///< by settings that nobody wrote into the file
    Session saved_edits_;  ///< edits() of what was read or written last
    Camera saved_camera_;
    glm::dvec3 saved_probe_voxel_{0.0};
    mutable std::optional<bool> edits_are_saved_;  ///< as it was found out last
};

}  // namespace shvr::ui
