#pragma once
// The open document: session, volume, mask and history, with the objects that show, edit and touch them. Main thread
// only, except that other threads read the document and write its files.
//
// Whether the document is saved is computed, not stored: the session as it would be saved is compared with the session
// last read or written. The comparison ignores the camera and the probe's position, since looking around changes them.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/trace/local_radius.h"
#include "engine/annotation/trace/trace_command.h"
#include "engine/jobs/progress_reporter.h"
#include "engine/live/far_voxels.h"
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
    /// All data that must be read before a document can be shown. It may be created on any thread.
    struct Read {
        OpenedSession opened;
        std::filesystem::path session_path;
        std::vector<std::string> overridden;
        std::unique_ptr<Work> work;
        std::vector<Notice> notices{};
        std::string holder{};
        std::string outside{};
        std::string remote{};
        std::string unsavable{};
        std::optional<std::string> session_text{};
        bool is_script = false;  ///< as WorkbenchOptions::is_script
    };
    /// Reads the saved work of a session. `overridden`: settings, as "key=value", in which the session differs from
    /// its file. If another process writes the work, if the session would write outside its folder and
    /// `may_write_outside` is not set, or if `input` is the address of a volume, the document is opened read-only.
    /// Fails if the work cannot be read. Any thread.
    static Read read(OpenedSession opened, const std::filesystem::path& input,
                     const std::vector<std::string>& overridden, Work::Opening opening, bool may_write_outside);
    /// Shows the document in the scene of its volume; fails like Scene::show. At first, the mouse moves the probe.
    Document(Renderer& renderer, Read read, const View::Options& view_options);
    Document(const Document&) = delete;

    std::filesystem::path session_path;  ///< where the session is saved
    Session session;                     ///< includes the probe's thresholds: the file's, or ones chosen for the volume
    std::shared_ptr<const VolumeSource> source;
    /// What the scene is made of: `source`, with coarser levels if the settings for which it was loaded need them.
    std::shared_ptr<const VolumeSource> scene_source;
    VolumeStatistics statistics;
    Camera camera;
    Annotator annotator;
    Previewer previewer{annotator};
    std::shared_ptr<const PaintPreview> operation_preview;  ///< is shown instead of the brush's; null: none
    ProbeMeter meter{annotator};
    Screen screen;
    Touch touch;
    std::vector<SurfaceLook> surfaces;  ///< moved out of the session, since views copy the session every frame
    std::vector<Notice> messages;       ///< notes from opening the work
    std::string holder;                 ///< description of another process that writes the work; empty: none
    std::string outside;                ///< files that the session may not write, since they are outside its folder;
                                        ///< empty: none, or the user has agreed (annotation_files.h)
    std::string remote;                 ///< address of the volume if that was opened, not a session that names it
    std::string unsavable;              ///< why no file can be written next to the session, as found when it was opened
                                        ///< (savable.h); empty: one can, or a save has succeeded since
    bool drags_node = false;            ///< the selection follows the probe
    glm::dvec3 drag_from{0.0};          ///< where the tools were when the drag began, in voxels: one selected node
                                        ///< moves to the probe, several parts move along

    // State of the open document that is not part of the work
    std::vector<glm::dvec3> measuring;                      ///< points of a measurement that is not complete yet
    std::optional<glm::dvec3> picked_pivot;                 ///< volume space
    std::optional<std::pair<uint32_t, uint32_t>> cut_ends;  ///< nodes that the last deletion separated
    /// Position of the probe when the last stroke ended. Until the probe moves, its ball does not hide the new paint.
    std::optional<glm::dvec3> painted_at;

    /// Loads everything onto the device again with the current settings. Fails like Renderer::load and
    /// Scene::show_surfaces.
    void load_again(Renderer& renderer);
    /// Shows the document in the renderer's scene, which is new and was made from the document's volume.
    void show_again(Renderer& renderer);

    const VolumeInfo& volume() const { return source->info(); }
    glm::dvec3 probe_voxel() const { return touch.probe() / volume().spacing; }
    /// Returns the point where tools act: the probe or, depending on the session's `probe.touch`, the centre of the
    /// structure it touches, a node in its ball, or a centre line that passes through its ball.
    ToolPlace tool_place() const;
    glm::dvec3 tool_voxel() const { return tool_place().point / volume().spacing; }
    /// Returns where tools would act if the probe were at `point` and the tools did not snap to anything.
    ToolPlace tool_place_at(const glm::dvec3& point) const;
    /// Returns which voxels the hand can feel: by default, those that the view shows.
    FeltLimits felt_limits() const;
    const BrushSettings& brush() const { return session.probe.brush; }
    /// Chooses the thresholds if they are missing. choose_for_volume() also chooses node radius and contrast of slices.
    void choose_thresholds(Session& of) const;
    void choose_for_volume(Session& of) const;
    double probe_radius() const { return brush().radius_voxels * volume().spacing.x; }
    ProbeLook probe_look() const;
    /// Returns an operation, with an empty path, that paints with the current brush at the probe's position.
    PaintOp stroke() const;
    PaintOp dab() const;
    /// Returns the node to select or to link to: within reach, the nearest node except the selected one.
    std::optional<uint32_t> nearby_node() const;
    TraceMarks trace_marks() const;
    /// Returns the operation that would move the selection if the drag ended now.
    MoveOp drag_move() const;
    TraceDefaults trace_defaults() const;
    /// Returns whether the last cut can be mended: both nodes still exist and are not linked.
    bool is_cut() const;
    /// Returns the largest ball around a point that fits into the structure above the paint threshold. `way`: direction
    /// of a line of sight; if given, the structure is the one that this line enters, at most the probe's radius away
    /// from it (local_radius.h). Null if unknown. Reads 30^3 voxels, up to 124^3 in wide structures. Fails if they are
    /// still being read from another machine.
    std::optional<LocalBall> ball_at(const glm::dvec3& voxel, const std::optional<glm::dvec3>& way = {});
    /// Returns the bounding box of the probe's ball; it contains at least one voxel of the volume.
    VoxelBox voxels_around_probe() const;
    /// The view and the probe, which are saved without a message, and whose changes do not count as unsaved work.
    struct Place {
        Camera camera;
        glm::dvec3 probe_voxel{0.0};
        double slices_zoom = 1.0;
        std::optional<glm::dvec3> slices_center, slices_cross;
        bool operator==(const Place&) const = default;
    };
    Place place() const;
    /// Returns the session as it would be saved, with the current view and probe.
    Session saved_session() const;
    /// is_saved(): whether the document could be closed without losing work or settings other than view and probe.
    bool has_session_file() const { return session_text_.has_value(); }
    bool is_saved() const { return work_is_saved() && edits_are_saved(); }
    bool work_is_saved() const { return only_looks() || annotator.work().is_saved(); }
    /// Returns whether the document is read-only: nothing can be painted or saved. why_only_looks() returns the reason.
    bool only_looks() const { return annotator.work().only_looks(); }
    std::string why_only_looks() const
    {
        return !remote.empty()   ? std::string("it lies on another machine")
               : outside.empty() ? "it is open for writing in " + holder
                                 : "its session writes outside its folder: " + outside;
    }
    /// Returns what messages call the document: the path of its session or, if there is none, its address.
    std::string shown_name() const { return remote.empty() ? session_path.string() : remote; }
    bool is_script() const { return is_script_; }
    /// Call this after changes of the session other than view and probe: clears the cached result of is_saved().
    void note_edit() { edits_are_saved_.reset(); }
    /// Writes view, probe and similar settings to the journal, if there is a journal. The history gets no step.
    void keep_settings();
    /// Adds all settings that changed since the last step to the history, as one step. Call it only while no stroke is
    /// running. Returns whether any setting had changed. `label`: what the step is called; empty: what differs.
    bool record_settings(const std::string& label = {});
    /// The same for some sections alone, in scripts too: what a script loads is kept, though not what --set states.
    bool record_sections(std::initializer_list<std::string_view> names);
    /// Applies the settings that the history holds after undo or redo.
    void take_settings();
    /// A background save of the state at which it began. Each file is replaced atomically: first mask, offsets and
    /// trace, then the session. If other programs changed a file meanwhile, their version is kept under another name.
    class Saving;
    enum class Parts { all, session, work };
    /// Begins a save without writing anything. Fails if nothing can be saved. Always call `end_save` after the save.
    std::shared_ptr<Saving> begin_save(Parts parts = Parts::all);
    /// Ends a save. Returns the parts that were written. A save under another name also renames the document.
    Work::Saved end_save(Saving& saving);
    /// Returns whether only the view or the probe changed and the session has a file. Such a change is saved silently;
    /// without a session file it is not saved, so that merely looking at a volume creates none.
    bool has_view_to_keep() const;
    /// Returns whether settings need saving. Returns false if some are overridden, since these apply to this run only.
    bool has_settings_to_save() const { return !edits_are_saved() && overridden_.empty(); }
    /// Begins a save under another name. Work continues under that name, with its whole history; existing files stay.
    /// Commands are refused until the save has ended. `path`: where to save the new session; must not exist.
    std::shared_ptr<Saving> begin_save_as(const std::filesystem::path& path);
    /// Returns a function that writes the current mask, offsets, trace and session to new files, on any thread, and
    /// returns the new session's path. `path`: the path to use; empty: an unused name nearby. Fails if the file exists.
    std::function<std::filesystem::path()> copier(const std::filesystem::path& path = {}) const;

private:
    static Read read_remote(OpenedSession opened, const std::filesystem::path& address,
                            const std::vector<std::string>& overridden);
    DensityBox densities_at_once(const VoxelBox& box);
    void take_kept_settings();
    void begin_with_turning();
    void name_trace();
    void name_sparse_files(Parts parts, Saving& saving);
    bool edits_are_saved() const;
    Session edits() const;
    void note_saved();

    FarVoxels far_;  ///< for ball_at, if the volume is on another machine
    bool is_script_ = false;
    std::vector<std::string> overridden_;      ///< settings that differ from the file
    std::optional<std::string> session_text_;  ///< contents of the session file when this process last read or wrote it
    Session saved_edits_;                      ///< result of edits() for the session last read or written
    Place saved_place_;
    mutable std::optional<bool> edits_are_saved_;  ///< cached answer of edits_are_saved()
};

/// Returns the path of the session for an input: a session file's own path or, for a volume or folder, one next to it.
std::filesystem::path session_path_of(const std::filesystem::path& input);
/// Returns the contents of the session file; null if there is no such file.
std::optional<std::string> text_of_session(const std::filesystem::path& path);

class Document::Saving {
public:
    Saving(const Saving&) = delete;
    /// Writes the files. Call this once, on any thread. Fails if any file cannot be written.
    void write(ProgressReporter& reporter);
    bool is_written() const { return is_written_; }
    bool is_under_another_name() const { return as_ != nullptr; }

private:
    friend struct Document;
    Saving() = default;
    void write_session();
    void write_names();

    std::unique_ptr<Work::Saving> work_;  ///< null: only the session is saved, or `as_` is set
    std::unique_ptr<Work::SavingAs> as_;  ///< set if the save is under another name
    std::filesystem::path session_path_;
    std::string text_;                       ///< contents of the session file to write
    std::optional<std::string> text_there_;  ///< contents of the existing file when this process last read or wrote it
    std::optional<AnnotationNames> names_;   ///< if only names of annotation files are saved: the names
    std::filesystem::path names_path_;
    Session edits_;
    Place place_;
    std::optional<Notice> notice_;
    bool has_session_ = false, is_written_ = false;
};

}  // namespace shvr::ui
