#pragma once
// The open document: session, volume, mask and history, with the objects that show, edit and touch them. Main thread,
// but a document is read and its files are written on other threads.
//
// Whether the document is saved is computed, not stored: the session as it would be saved is compared with the session
// last read or written. The comparison ignores the camera and the probe's position, since looking around changes them.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "engine/annotation/trace/local_radius.h"
#include "engine/annotation/trace/trace_command.h"
#include "engine/jobs/progress_reporter.h"
#include "engine/live/previewer.h"
#include "engine/live/probe_meter.h"
#include "engine/live/screen.h"
#include "engine/picture/picture_job.h"
#include "engine/session/annotation_files.h"
#include "engine/session/session.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/document/touch.h"
#include "engine/workbench/models/sight.h"

namespace shvr::ui {

struct Document {
    /// All data that is read before a document can be shown. Created on any thread.
    struct Read {
        OpenedSession opened;
        std::filesystem::path session_path;
        std::vector<std::string> overridden;
        std::unique_ptr<Work> work;
        std::vector<Notice> notices{};
        std::string holder{};
        std::string outside{};
        std::optional<std::string> session_text{};
        bool is_script = false;  ///< as WorkbenchOptions::is_script
    };
    /// Reads the saved work of a session. `overridden`: "key=value" settings in which the session differs from its
    /// file. `hold`: the hold of the document to be replaced, possibly the same document. If another process writes the
    /// work, or if the session would write outside its folder and `may_write_outside` is not set, the document is
    /// opened read-only. Fails if it cannot be read. Any thread.
    static Read read(OpenedSession opened, const std::filesystem::path& input,
                     const std::vector<std::string>& overridden, Work::Opening opening, bool may_write_outside);
    /// Shows the document in the scene, which has its volume. Fails like Scene::show. The mouse moves the probe.
    Document(Renderer& renderer, Read read, const View::Options& view_options);
    Document(const Document&) = delete;

    std::filesystem::path session_path;  ///< where the session is saved
    Session session;                     ///< includes the probe's thresholds: the file's, or ones chosen for the volume
    std::shared_ptr<const VolumeSource> source;
    VolumeStatistics statistics;
    Camera camera;
    Annotator annotator;
    Previewer previewer{annotator};
    ProbeMeter meter{annotator};
    Screen screen;
    Touch touch;
    std::vector<SurfaceLook> surfaces;  ///< moved out of the session, since views copy the session every frame
    std::vector<Notice> messages;       ///< notes from opening the work
    std::string holder;                 ///< description of another process that writes the work; empty: none
    std::string outside;                ///< files that the session would write outside its folder, if the user has not
                                        ///< agreed to that (annotation_files.h); empty: none
    bool drags_node = false;            ///< the selection follows the probe
    glm::dvec3 drag_from{0.0};          ///< place of the tools when the drag began, in voxels. A single selected node
                                        ///< moves to the probe; several parts keep their distance from it

    // State of the open document that is not part of the work
    std::optional<glm::dvec3> measuring_from;               ///< first end of a measurement that lacks its second end
    std::optional<glm::dvec3> picked_pivot;                 ///< volume space
    std::optional<std::pair<uint32_t, uint32_t>> cut_ends;  ///< nodes that the last deletion separated
    /// Probe position at the end of the last stroke. Until the probe moves, its ball is not drawn over the fresh paint.
    std::optional<glm::dvec3> painted_at;

    /// Loads everything onto the device again with the current settings. Fails like Renderer::load and
    /// Scene::show_surfaces.
    void load_again(Renderer& renderer);
    /// Shows the document in the renderer's scene, which is a new scene with the document's volume.
    void show_again(Renderer& renderer);

    const VolumeInfo& volume() const { return source->info(); }
    glm::dvec3 probe_voxel() const { return touch.probe() / volume().spacing; }
    /// Returns the point where tools act: the probe or, depending on the session's `probe.touch`, the centre of the
    /// structure it touches, a node in its ball, or a centre line that passes through its ball.
    ToolPlace tool_place() const;
    glm::dvec3 tool_voxel() const { return tool_place().point / volume().spacing; }
    /// Returns where tools would act if the probe were at `point` and touched nothing.
    ToolPlace tool_place_at(const glm::dvec3& point) const;
    /// Returns the limits of the voxels that can be felt: by default the voxels that the view shows.
    FeltLimits felt_limits() const;
    const BrushSettings& brush() const { return session.probe.brush; }
    /// Chooses missing thresholds for the volume; choose_for_volume() also chooses node size and the slices' contrast.
    void choose_thresholds(Session& of) const;
    void choose_for_volume(Session& of) const;
    double probe_radius() const { return brush().radius_voxels * volume().spacing.x; }
    ProbeLook probe_look() const;
    /// Returns a stroke with the current brush at the probe's position, without a path.
    PaintOp stroke() const;
    PaintOp dab() const;
    /// Returns the node to select or to link with: the nearest one within reach that is not selected.
    std::optional<uint32_t> nearby_node() const;
    TraceMarks trace_marks() const;
    /// Returns the operation that moves the selection if the drag ends now.
    MoveOp drag_move() const;
    TraceDefaults trace_defaults() const;
    /// Returns whether the cut can still be mended: both of its ends exist, and no link joins them.
    bool is_cut() const;
    /// Returns the largest ball in the structure above the paint threshold at a point. If `way` is given, the structure
    /// is that which a line of sight in this direction enters there, at most the probe's radius to the side of the line
    /// (local_radius.h). Null if it is unknown. Reads 30^3 voxels, up to 124^3 in wide structures.
    std::optional<LocalBall> ball_at(const glm::dvec3& voxel, const std::optional<glm::dvec3>& way = {}) const;
    /// Returns the bounding box of the probe's ball; it contains at least one voxel of the volume.
    VoxelBox voxels_around_probe() const;
    /// The view and the probe. They are saved without a message, and do not count as changes of the work.
    struct Place {
        Camera camera;
        glm::dvec3 probe_voxel{0.0};
        double slices_zoom = 1.0;
        std::optional<glm::dvec3> slices_center;
        bool operator==(const Place&) const = default;
    };
    Place place() const;
    /// Returns the session as it would be saved, with the current view and probe.
    Session saved_session() const;
    /// is_saved(): whether closing loses neither work nor settings, except perhaps the view and the probe.
    bool has_session_file() const { return session_text_.has_value(); }
    bool is_saved() const { return work_is_saved() && edits_are_saved(); }
    bool work_is_saved() const { return only_looks() || annotator.work().is_saved(); }
    /// Returns whether the document is read-only: painting and saving are unavailable. why_only_looks(): the reason.
    bool only_looks() const { return annotator.work().only_looks(); }
    std::string why_only_looks() const
    {
        return outside.empty() ? "it is open for writing in " + holder
                               : "its session writes outside its folder: " + outside;
    }
    bool is_script() const { return is_script_; }
    /// Call after any possible change of the session, except of view and probe: clears the cached result of is_saved().
    void note_edit() { edits_are_saved_.reset(); }
    /// Writes view, probe and similar settings to the journal, if there is one; adds no step to the history.
    void keep_settings();
    /// Adds all settings changed since the last step to the history, as one step. Call it only while no stroke is
    /// running. Returns whether there was anything to record.
    bool record_settings();
    /// Applies the settings of the work's history, after undo and redo.
    void take_settings();
    /// A save in the background, of the state at its start. Each file is replaced atomically: first mask, offsets and
    /// trace, then the session. Files that other programs changed meanwhile are kept under other names.
    class Saving;
    enum class Parts { all, session, work };
    /// Fails if nothing can be saved; writes nothing. `end_save` must be called afterwards, whatever the save's result.
    std::shared_ptr<Saving> begin_save(Parts parts = Parts::all);
    /// Returns the parts that were written. After a save under another name, the document has that name.
    Work::Saved end_save(Saving& saving);
    /// Returns whether only view or probe changed, and the session has a file: saving these needs no message. Merely
    /// looking at a volume thus creates no file.
    bool has_view_to_keep() const;
    /// Returns whether settings must be saved; false while any setting is overridden for this run.
    bool has_settings_to_save() const { return !edits_are_saved() && overridden_.empty(); }
    /// Saves under another name. The work continues there with the whole history, and existing files stay unchanged.
    /// Commands are refused until the save has ended. `path`: the new session's. Fails if a file of that name exists.
    std::shared_ptr<Saving> begin_save_as(const std::filesystem::path& path);
    /// Returns a function that writes the current mask, offsets, trace and session to new files, on any thread, and
    /// returns the session's path. `path`: that path; empty: an unused one next to this session. Fails if it exists.
    std::function<std::filesystem::path()> copier(const std::filesystem::path& path = {}) const;

private:
    void take_kept_settings();
    void begin_with_turning();
    void name_trace();
    void name_sparse_files(Parts parts, Saving& saving);
    bool edits_are_saved() const;
    Session edits() const;
    void note_saved();

    bool is_script_ = false;
    std::vector<std::string> overridden_;      ///< settings that differ from the file
    std::optional<std::string> session_text_;  ///< contents of the session file when this process last read or wrote it
    Session saved_edits_;                      ///< result of edits() for the session last read or written
    Place saved_place_;
    mutable std::optional<bool> edits_are_saved_;  ///< cached answer of edits_are_saved()
};

/// Returns a session's path: for a session file, the file's own path; for a volume or folder, a path next to it.
std::filesystem::path session_path_of(const std::filesystem::path& input);
/// Returns the file's contents; no value if there is no such file.
std::optional<std::string> text_of_session(const std::filesystem::path& path);

class Document::Saving {
public:
    Saving(const Saving&) = delete;
    /// Writes the files. Call once, on any thread. Fails if a file cannot be written.
    void write(ProgressReporter& reporter);
    bool is_written() const { return is_written_; }
    bool is_under_another_name() const { return as_ != nullptr; }

private:
    friend struct Document;
    Saving() = default;
    void write_session();
    void write_names();

    std::unique_ptr<Work::Saving> work_;  ///< null: the session alone is saved, or
    std::unique_ptr<Work::SavingAs> as_;  ///< the save is under another name
    std::filesystem::path session_path_;
    std::string text_;                       ///< contents of the session file to write
    std::optional<std::string> text_there_;  ///< contents of the existing file when this process last read or wrote it
    std::optional<AnnotationNames> names_;   ///< written into the session file if the session is not saved otherwise
    std::filesystem::path names_path_;
    Session edits_;
    Place place_;
    std::optional<Notice> notice_;
    bool has_session_ = false, is_written_ = false;
};

}  // namespace shvr::ui
