#pragma once
// The open document: session, volume, mask and history, with the objects that show, edit and touch them. Main thread;
// reading one and writing its files are work for another.
//
// Whether it is saved is computed, not stored: the session as it would be saved is compared with the one last read or
// written. The comparison ignores the camera and the probe's position, since looking around changes them.

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
#include "engine/session/session.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/document/touch.h"
#include "engine/workbench/models/sight.h"

namespace shvr::ui {

struct Document {
    /// All that is read before a document can be shown. Made on any thread.
    struct Read {
        OpenedSession opened;
        std::filesystem::path session_path;
        std::vector<std::string> overridden;
        std::unique_ptr<Work> work;
        std::vector<Notice> notices{};
        std::string holder{};
        std::optional<std::string> session_text{};
        bool is_script = false;  ///< as WorkbenchOptions::is_script
    };
    /// Reads the saved work of a session. `overridden`: "key=value" settings in which the session differs from its
    /// file. `hold`: of the document that this one replaces, which may be the same. Where another process writes the
    /// work, it is only looked at. Fails where it cannot be read. Any thread.
    static Read read(OpenedSession opened, const std::filesystem::path& input,
                     const std::vector<std::string>& overridden, Work::Opening opening);
    /// Shows it in the renderer's scene, which is of its volume. Fails as Scene::show does. The mouse moves the probe.
    Document(Renderer& renderer, Read read, const View::Options& view_options);
    Document(const Document&) = delete;

    std::filesystem::path session_path;  ///< where the session is saved
    Session session;                     ///< the probe's thresholds are set, from the volume where the file states none
    std::shared_ptr<const VolumeSource> source;
    VolumeStatistics statistics;
    Camera camera;
    Annotator annotator;
    Previewer previewer{annotator};
    ProbeMeter meter{annotator};
    Screen screen;
    Touch touch;
    std::vector<SurfaceLook> surfaces;  ///< moved out of the session, since views copy the session every turn
    std::vector<Notice> messages;       ///< notes from opening the work
    std::string holder;                 ///< the other process that writes the work, in words; empty: this one may
    bool drags_node = false;            ///< the selected node follows the probe

    // What is kept while it is open, and is no part of the work
    std::optional<glm::dvec3> measuring_from;               ///< the first end of one that has no second yet
    std::optional<glm::dvec3> picked_pivot;                 ///< volume space
    std::optional<std::pair<uint32_t, uint32_t>> cut_ends;  ///< nodes between which the last deletion cut the trace
    /// The probe where its last stroke ended: until it moves on, its ball leaves what was painted to be seen.
    std::optional<glm::dvec3> painted_at;

    /// Loads everything onto the device again, as its settings now say. Fails as load and create do.
    void load_again(Renderer& renderer);
    /// Shows it in the renderer's scene, a new one of its volume.
    void show_again(Renderer& renderer);

    const VolumeInfo& volume() const { return source->info(); }
    glm::dvec3 probe_voxel() const { return touch.probe() / volume().spacing; }
    /// Where tools act: at the probe or, as the session's `probe.touch` says, at the middle of what it touches, at a
    /// node in its ball, or on a centre line that passes through it.
    ToolPlace tool_place() const;
    glm::dvec3 tool_voxel() const { return tool_place().point / volume().spacing; }
    /// Where they would act with the probe at a point, and nothing touched.
    ToolPlace tool_place_at(const glm::dvec3& point) const;
    const BrushSettings& brush() const { return session.probe.brush; }
    /// Thresholds that are not given are chosen for the volume; likewise the size of nodes and the slices' contrast.
    void choose_thresholds(Session& of) const;
    void choose_for_volume(Session& of) const;
    double probe_radius() const { return brush().radius_voxels * volume().spacing.x; }
    ProbeLook probe_look() const;
    /// A stroke of the brush as it would paint now, without a path; at the probe's position.
    PaintOp stroke() const;
    PaintOp dab() const;
    /// The node to select or link with: the nearest unselected one within reach.
    std::optional<uint32_t> nearby_node() const;
    TraceMarks trace_marks() const;
    TraceDefaults trace_defaults() const;
    /// The cut can still be mended: both of its ends exist, and nothing links them.
    bool is_cut() const;
    /// The largest ball in what lies at a place, above the paint threshold; with `way`, in what a line of sight enters
    /// there, no further aside than the probe's ball reaches (local_radius.h). Null where that cannot be told. Reads
    /// 30^3 voxels, up to 124^3 where it is wide.
    std::optional<LocalBall> ball_at(const glm::dvec3& voxel, const std::optional<glm::dvec3>& way = {}) const;
    /// The probe's ball, of at least one voxel of the volume.
    VoxelBox voxels_around_probe() const;
    /// Where one looks and works, which is kept without a word and is no change of the work.
    struct Place {
        Camera camera;
        glm::dvec3 probe_voxel{0.0};
        double slices_zoom = 1.0;
        std::optional<glm::dvec3> slices_center;
        bool operator==(const Place&) const = default;
    };
    Place place() const;
    /// The session as it would be saved: with that place.
    Session saved_session() const;
    /// Closing would lose no work and no setting, except perhaps the place.
    bool has_session_file() const { return session_text_.has_value(); }
    bool is_saved() const { return work_is_saved() && edits_are_saved(); }
    bool work_is_saved() const { return only_looks() || annotator.work().is_saved(); }
    /// Nothing can be painted or saved: another process writes the work.
    bool only_looks() const { return annotator.work().only_looks(); }
    bool is_script() const { return is_script_; }
    /// Call after anything that may have changed the session, except the place: clears the cached answer of is_saved().
    void note_edit() { edits_are_saved_.reset(); }
    /// Puts view, probe and the like into the journal, where there is one; no step of the history.
    void keep_settings();
    /// Makes a step of the history of what was set since the last one. Not while a stroke is running.
    /// Returns whether there was anything to record.
    bool record_settings();
    /// Takes the settings of the work, after undo and redo.
    void take_settings();
    /// A save beside the work: files as they are to be when it began. Each appears whole or not at all: the mask, the
    /// offsets and the trace, then the session. What others wrote there in the meantime is kept under other names.
    class Saving;
    enum class Parts { all, session, work };
    /// Fails where nothing can be saved; writes nothing. `end_save` must follow, whatever became of it.
    std::shared_ptr<Saving> begin_save(Parts parts = Parts::all);
    /// Returns what was written. After a save under another name the document has that.
    Work::Saved end_save(Saving& saving);
    /// Only the place changed, and the session has a file: saving it is worth no word. So just looking at a volume
    /// creates no file.
    bool has_view_to_keep() const;
    /// Only settings that have a file are to be saved.
    bool has_settings_to_save() const { return !edits_are_saved() && overridden_.empty(); }
    /// The same under another name, with which the work goes on, with the whole history; the files so far stay as they
    /// are. Until it has ended, commands are refused. `path`: of the session. Fails where a file of that name exists.
    std::shared_ptr<Saving> begin_save_as(const std::filesystem::path& path);
    /// Writes mask, offsets, trace and session as they are now into new files, on any thread. `path`: of the session;
    /// empty: a free one beside this. Returns it. Fails where a file of that name exists.
    std::function<std::filesystem::path()> copier(const std::filesystem::path& path = {}) const;

private:
    void take_kept_settings();
    void begin_with_turning();
    void name_trace();
    bool edits_are_saved() const;
    Session edits() const;
    void note_saved();

    bool is_script_ = false;
    std::vector<std::string> overridden_;      ///< settings that are not in the file
    std::optional<std::string> session_text_;  ///< of the file, as this process last read or wrote it
    Session saved_edits_;                      ///< edits() of the session last read or written
    Place saved_place_;
    mutable std::optional<bool> edits_are_saved_;  ///< cached answer of edits_are_saved()
};

/// A session file is saved in place; for a volume, file or folder, the session file is put beside it.
std::filesystem::path session_path_of(const std::filesystem::path& input);
/// Nothing where there is no file.
std::optional<std::string> text_of_session(const std::filesystem::path& path);

class Document::Saving {
public:
    Saving(const Saving&) = delete;
    /// On any thread, once. Fails where a file cannot be written.
    void write(ProgressReporter& reporter);
    bool is_written() const { return is_written_; }
    bool is_under_another_name() const { return as_ != nullptr; }

private:
    friend struct Document;
    Saving() = default;
    void write_session();

    std::unique_ptr<Work::Saving> work_;  ///< null: the session alone, or
    std::unique_ptr<Work::SavingAs> as_;  ///< under another name
    std::filesystem::path session_path_;
    std::string text_;                       ///< of the session
    std::optional<std::string> text_there_;  ///< as this process last read or wrote it
    Session edits_;
    Place place_;
    std::optional<Notice> notice_;
    bool has_session_ = false, is_written_ = false;
};

}  // namespace shvr::ui
