#pragma once
// Everything a person can do, without a window: the open document, the actions on it, the work that goes on beside
// them, and what there is to say. The window, scripts and tests are its callers; keys, menus and panels only make
// actions (action.h).
//
//   actions -> perform -> Session, Annotator, Touch -> advance: touch, settings, stroke, preview, view, screenshots
//
// One thread, the one that owns the renderer, besides the servo's (haptics/servo.h), those of jobs and savers, and one
// that writes a screenshot.
// `advance` never waits for the device, nor for a disk: files are read and written by jobs,
// and a volume that is opened goes onto the device in slices of a few milliseconds. A turn in which nothing happens
// costs microseconds (MEASURED.md).

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "engine/jobs/jobs.h"
#include "engine/tasks/file_content.h"
#include "ui/workbench/action_rows.h"
#include "ui/workbench/document/document.h"
#include "ui/workbench/document/screenshots.h"
#include "ui/workbench/lists/pass_log.h"
#include "ui/workbench/lists/recent_actions.h"
#include "ui/workbench/messages.h"
#include "ui/workbench/preferences.h"
#include "ui/workbench/sight/hits.h"
#include "ui/workbench/touch/device_watch.h"
#include "ui/workbench/touch/hand_view.h"

namespace shvr::ui {

/// The last part of a path, also of a folder with a slash at its end.
std::string short_name(const std::filesystem::path& path);

struct WorkbenchOptions {
    View::Options view{};
    bool has_servo = true;  ///< guidance and haptic devices run; false: guidance is a setting that nobody follows
    /// For scripts, which do what they state and nothing else: no setting becomes a step or is kept, saves write
    /// annotation alone, to the files that the session names, and what is selected stays so.
    bool is_script = false;
    bool allow_force = false;             ///< lets a haptic device with a verified profile push the hand
    std::filesystem::path preferences{};  ///< the file (preferences.h); empty: none are read or kept
    std::function<double()> now_s{};      ///< seconds of any clock; null: the system's
    std::string version{};                ///< of the program, for reports; empty: not told
    DeviceSource devices{};               ///< where haptic devices come from; without functions: this machine
    /// Slices go after a probe that leaves their sight, which is logged; false: the log says where they went.
    bool slices_follow = true;
    TextDrawer draw_texts{};  ///< for pictures in files; null: these have no words
};

class Workbench {
public:
    Workbench(Renderer& renderer, WorkbenchOptions options);
    ~Workbench();
    Workbench(const Workbench&) = delete;

    // ---- Actions

    /// Carries it out. Fails, with nothing changed, with the reason; then the caller says it.
    void perform(const Action& action);
    /// The same; a failure becomes a message, but for DeviceLost. Returns whether it was carried out.
    bool apply(const Action& action);
    /// Opens beside the work, with settings as --set takes them, as the action Open does: what is open stays until the
    /// next is there, and is saved before that. A failure becomes a message.
    void begin_open(const std::filesystem::path& path, const std::vector<std::string>& settings);
    /// The same, and waits until it is there; saves nothing before. Fails where it cannot be opened.
    void open(const std::filesystem::path& path, const std::vector<std::string>& settings, Work::Opening how = {});
    /// Takes what the caller has opened; the renderer's scene is of its volume.
    void take(Document::Read read);
    void say(std::string text, Weight weight = Weight::done);
    /// After the graphics device was lost (DeviceLost, from any function here): drops what the workbench has on it,
    /// calls `make_anew`, and shows all again. What is recorded is all there; of a stroke under way, what was not
    /// painted yet is not.
    void restart_device(const std::function<void()>& make_anew);
    /// From now on this device moves the probe, whatever is plugged in, and its button paints.
    void use_device(std::shared_ptr<HapticDevice> device, const std::string& name);
    /// Called with each action that was carried out, as a line that replays it (action_rows.h).
    void log_to(std::function<void(const std::string& line)> log) { log_ = std::move(log); }

    // ---- Turns

    /// Size of the picture; 0, 0: none is drawn.
    void set_pixels(const glm::uvec2& pixels);
    /// Where the mouse is; null: not over the picture. What is there is read.
    void set_pointer(const std::optional<Pointer>& pointer) { pointer_ = pointer; }
    /// What was to be copied since the last call; empty: nothing.
    std::string take_clipboard() { return std::exchange(clipboard_, {}); }
    /// While a hand is setting something no step of the history is made of it: one drag is one step.
    void set_hand_down(bool is_down) { is_hand_down_ = is_down; }
    /// Pixels of one unit of the interface, for what is drawn over pictures.
    void set_units(double units) { units_ = units; }
    /// Nothing else waits for the device: large screenshots may go on.
    void set_still(bool is_still) { is_still_ = is_still; }
    /// Does a turn of all that goes on beside the actions. Failures become messages, and that part is tried again a
    /// little later: whatever fails, the rest goes on and no work is lost. DeviceLost is thrown.
    void advance();
    /// Turns until a running stroke is painted. Returns why part of it was not; empty if all was.
    std::string finish_stroke();
    /// Waits for what is being saved. Returns what was written; fails with the reason where that is not all.
    Work::Saved finish_save();
    /// Waits until all that was done is on disk, in the journal; fails with the reason if that is not possible.
    void flush();
    /// Whether another turn at once would find something to do.
    bool has_work() const;
    /// Whether there is a picture that does not yet show what was done last.
    bool is_stirring() const { return pixels_.x > 0 && pixels_.y > 0 && (look_is_stale_ || camera_moved_); }
    /// Whether what is open may be closed: call it turn by turn. Saves all work as Save does; if the person only looked
    /// around, saves the view silently. Where the work is only looked at, nothing is saved, as was said; while it is
    /// asked what to believe, annotation stays as the journal has it.
    enum class Leave {
        now,
        later,    ///< something is being saved; all can be used meanwhile
        refused,  ///< it cannot be saved; `why` says why, once
    };
    Leave leave(std::string& why);
    bool is_saving() const { return save_ != nullptr || wanted_save_; }
    /// Whether anything is to be seen of jobs.
    bool shows_jobs() const
    {
        return opening_ || is_saving() || !copies_.empty() || reload_ || screenshots_.has_large() || !jobs_.is_idle();
    }

    // ---- What there is to see

    bool is_open() const { return document_ != nullptr; }
    const Document& document() const { return *document_; }
    Screen& screen() { return document_->screen; }
    Model model() const;
    std::string why_not(const Action& action) const { return ui::why_not(model(), action); }
    const MessageLog& messages() const { return messages_; }
    bool takes_large_screenshot() const { return screenshots_.has_large(); }
    void wait_for_screenshots() const { screenshots_.wait(); }
    /// Quit was asked for; asking clears it.
    bool take_quit() { return std::exchange(quits_, false); }
    /// What the keyboard was asked to be given to, once; empty: nothing.
    std::string take_focus() { return std::exchange(focus_, {}); }
    /// Whether lines show what the cutting planes leave: while they are moved, and a little longer.
    bool shows_cut_box() const { return options_.now_s() < cut_shown_until_s_; }
    bool shows_full_screen() const { return is_full_screen_; }
    /// Voxels that the preview showed when the last stroke began, if it had one.
    std::optional<int64_t> previewed_at_stroke() const { return previewed_at_stroke_; }
    /// When the open document was opened, and how often one was.
    double opened_s() const { return opened_s_; }
    uint64_t openings() const { return openings_; }

private:
    /// Of a turn, for the slices of a volume.
    static constexpr double SLICE_S = 0.005;
    /// Of what goes on beside the jobs: no job has these numbers.
    static constexpr Jobs::Number RELOADING = Jobs::Number{1} << 49, DRAWING = RELOADING + 1;
    /// A part of a turn.
    struct Attempt {
        std::string said;       ///< message of the last failure
        double failed_s = 0.0;  ///< when that was; 0: never
        double again_s = 0.0;
    };
    void attempt(Attempt& state, const std::function<void()>& part);
    void note_failure(Attempt& state, const std::string& why);

    // One for each action.
    void act(const Orbit& action);
    void act(const Roll& action);
    void act(const Move& action);
    void act(const Zoom& action);
    void act(const DragInMap& action);
    void act(const LookFrom& action);
    void act(const KeepCamera& action);
    void act(const ForgetCamera& action);
    void act(const RenameCamera& action);
    void act(const PivotAt& action);
    void act(const GoTo& action);
    void act(const MoveCut& action);
    void act(const MoveClip& action);
    void act(const PlaceClips& action);
    void act(const ResetCuts& action);
    void act(const FitView& action);
    void act(const ResetView& action);
    void act(const LookAtSelection& action);
    void act(const UpdateOcclusion& action);
    void act(const Set& action);
    void act(const NewGroup& action);
    void act(const EndStep& action);
    void act(const AutoContrast& action);
    void act(const KeepPreset& action);
    void act(const RenamePreset& action);
    void act(const ForgetPreset& action);
    void act(const TakePreset& action);
    void act(const ProbeTo& action);
    void act(const ProbeOnto& action);
    void act(const ProbeAlong& action);
    void act(const PushProbe& action);
    void act(const PlaceProbe& action);
    void act(const ScaleProbe& action);
    void act(const Paint& action);
    void act(const PaintOp& action);
    void act(const DragNode& action);
    void act(const NodeOp& op) { trace(op); }
    void act(const SelectOp& op) { trace(op); }
    void act(const SelectSegmentOp& op) { trace(op); }
    void act(const DeselectOp& op) { trace(op); }
    void act(const LinkOp& op) { trace(op); }
    void act(const MoveOp& op) { trace(op); }
    void act(const DeleteOp& op) { trace(op); }
    void act(const GroupOp& op) { trace(op); }
    void act(const RadiusOp& op) { trace(op); }
    void act(const NodeAt& action);
    void act(const SelectAt& action);
    void act(const StepNode& action);
    void act(const MendCut& action);
    void act(const MeasureAt& action);
    void act(const ClearMeasurements& action);
    void act(const CopyMeasurements& action);
    void act(const UndoOp& action);
    void act(const RedoOp& action);
    void act(const SaveOp& action);
    void act(const RevertOp& action);
    void act(const SaveAs& action);
    void act(const CopySession& action);
    void act(const ExportTask& task);
    void act(const ImportTask& task);
    void act(const LabelTask& task);
    void act(const EvaluateTask& task);
    void act(const CancelJob& action);
    void act(const Screenshot& action);
    void act(const Open& action);
    void act(const LookAtFile& action);
    void act(const TakeFile& action);
    void act(const CorrectSpacing& action);
    void act(const DismissNotices& action);
    void act(const ChooseBelief& action);
    void act(const WorkOnCopy& action);
    void act(const OpenExample& action);
    void act(const ChooseKeys& action);
    void act(const BindKeys& action);
    void act(const Resize& action);
    void act(const ForgetRecent& action);
    void act(const AskOpen& action);
    void act(const ShowHelp& action);
    void act(const AwaitKey& action);
    void act(const ShowMessages& action);
    void act(const ShowPasses& action);
    void act(const SavePasses& action);
    void act(const ComparePasses& action);
    void act(const ShowPalette& action);
    void act(const Prefer& action);
    void act(const ShowPreferences& action);
    void act(const FocusOn& action);
    void act(const ShowFullScreen& action);
    void act(const Quit& action);
    void act(const LetGo& action);
    void act(const GrabVolume& action);
    void act(const UseDevice& action);
    void act(const FindDevices& action);
    void act(const CalibrateDevice& action);
    void act(const RecordStylus& action);
    void act(const StopRecording& action);
    void act(const FollowStylus& action);

    // Documents (workbench_open.cpp)
    struct Opening;
    void start_opening(Opening next);
    void read_next();
    void follow_opening();
    bool is_ready_to_load();
    void begin_loading();
    void finish_opening();
    void welcome(const std::filesystem::path& path, const std::vector<std::string>& losses);
    void show_picture(const Session& pictured);
    void end_opening(std::exception_ptr failure);
    void cancel_opening();
    /// As it was thrown, or in words.
    std::exception_ptr opening_failure(const std::string& words) const;
    Jobs::Number opening_number() const;
    void bring_back();
    Jobs::State state_of(const Opening& opening) const;
    std::string_view opening_name() const;
    std::vector<Jobs::State> job_states() const;
    void stop_loading();
    void load_again();

    // Loading once more (workbench_reload.cpp)
    struct Reload;
    void want_reload(const RenderSettings& before);
    void begin_reload();
    void follow_reload();
    bool cancel_reload();
    Jobs::State state_of_reload() const;
    void drop_queries();

    void load_once_more();
    std::filesystem::path screenshot_stem() const;
    void drop_large_screenshot(const char* by);
    Figure figure_of_picture(uint32_t scale) const;
    Screenshots::Texts texts_of_picture(const glm::uvec2& pixels, bool shows_probe) const;

    // Jobs and saving (workbench_save.cpp)
    void follow_jobs();
    void discard();
    void follow_save();
    void save_to(const std::filesystem::path& path);
    void begin_save(bool is_asked_for, Document::Parts parts = Document::Parts::all);
    void begin_save_as(const std::filesystem::path& path);
    void begin_save_to(const std::filesystem::path& path);
    void start_saving(std::shared_ptr<Document::Saving> saving, bool is_asked_for);
    void start_copy(const std::filesystem::path& path, bool opens_it);
    void end_save(const Jobs::Finished& job);
    void take(FileContent content, const std::filesystem::path& path);
    void take_transfer_function(const std::filesystem::path& path, const std::string& text);
    void take_together(std::vector<std::filesystem::path> paths);
    void begin_open_with(const std::filesystem::path& path, std::vector<std::filesystem::path> taken_into_it);
    void take_annotation(Part part, const std::filesystem::path& path);

    // Own transfer functions
    std::filesystem::path preset_folder() const;
    const TransferPreset& own_preset(const std::string& name) const;
    std::filesystem::path free_preset_file(const std::string& name) const;
    void load_presets();

    // Preferences
    void load_preferences();
    void prefer(Preferences preferences);

    // Looking
    Pane pane(size_t index) const;
    void look_again() { look_is_stale_ = true; }
    void look_from(const Camera& camera);
    void show_slices(SliceSettings slices);
    void follow_slices();
    glm::dvec3 pivot() const;
    /// What is seen at a pixel of a pane, volume space; of a slice, the point of its plane. Null: nothing is.
    std::optional<glm::dvec3> seen_at(const Pane& pane, const glm::dvec2& pixel) const;
    /// What of it lies within `reach` of a depth along the view.
    std::optional<glm::dvec3> seen_near(const Pane& pane, const glm::dvec2& pixel, double depth, double reach) const;
    void follow_reading();
    void read_at(const glm::dvec3& voxel);
    bool probe_is_measured() const;
    bool is_hidden(const Pane& pane, const glm::dvec2& pixel, const TraceHit& hit) const;
    glm::dvec3 voxel_to_read() const;

    // Settings
    void take_session(Session session);
    void settings_changed(const Session& before);
    void note_edit();
    void record_settings();
    void note_to_keep();
    void follow_view();

    // Annotation
    void trace(const TraceOp& op);
    TraceOp with_radius(TraceOp op) const;
    std::optional<ToolPlace> line_at(const Pane& pane, const glm::dvec2& pixel) const;
    bool add_drawn_node(const ToolPlace& place);
    std::optional<uint32_t> node_in_voxel(const glm::dvec3& voxel) const;
    void select_segment();
    void note_cut(std::optional<std::pair<uint32_t, uint32_t>> ends);
    std::string keys_of(const char* shortcut) const;
    /// "; Ctrl + T sets that"; empty where the shortcut has no key.
    std::string with_key(const char* before, const char* shortcut, const char* after) const;
    std::string how_to_reach_this() const;
    void move_probe(const glm::dvec3& point, bool jumps);
    void lift();
    void log_instead(const Actions& actions);
    void extend_stroke();
    void stroke_ended();
    void await_strokes();
    void show_changes(const Command& command);
    bool follows_empty_stroke();
    template <class Way>
    void step(int count, const char* done, const char* nothing, Way way);

    // The hand (workbench_touch.cpp)
    TouchSettings touch_settings() const;
    void follow_touch();
    void follow_devices();
    void follow_puck();
    void follow_grab();
    void choose_device();
    void take_device(std::shared_ptr<HapticDevice> device, const DeviceListing& row);
    void leave_device();
    const DeviceListing* wanted_device() const;
    void note_hand();
    void finish_recording();
    void add_node_here();
    Actions add_node_at(const Action& action);
    void follow_points(const std::vector<StylusPoint>& points, double node_every);

    // Turns
    void follow_buttons(uint32_t buttons);
    void follow_settings();
    void follow_stroke();
    void advance_stroke();
    bool tries_stroke(std::string& unpainted);
    void follow_preview();
    void follow_look();
    void follow_screenshots();

    Renderer& renderer_;
    WorkbenchOptions options_;
    std::unique_ptr<Document> document_;
    std::vector<TransferPreset> presets_;
    MessageLog messages_;
    Preferences preferences_;
    Keymap keymap_;
    std::string awaits_key_;  ///< id of the shortcut that the next key is for; empty: none
    bool are_preferences_kept_ = false;
    Screenshots screenshots_;
    std::function<void(const std::string&)> log_;
    RecentActions recent_;
    Jobs jobs_;
    Jobs savers_{{.wake = {}, .seconds = {}, .first = Jobs::Number{1} << 32}};  ///< no save waits for other work
    std::shared_ptr<Opening> opening_;                                          ///< null: nothing is being opened
    std::shared_ptr<std::exception_ptr> awaited_failure_;  ///< where `open` waits for what ends an opening
    std::shared_ptr<Reload> reload_;                       ///< null: what is shown is as the settings say
    Jobs::Number next_return_ = Jobs::Number{1} << 48;     ///< so that it is no job's
    std::unique_ptr<Document> away_;  ///< what was open, without a scene, while the device has room for one only
    /// What is being saved.
    struct Save {
        Jobs::Number number = 0;
        std::shared_ptr<Document::Saving> saving;
        bool is_asked_for = true;  ///< otherwise nothing is said where all goes well
    };
    std::unique_ptr<Save> save_;
    /// Once the stroke, or the save, under way has ended. Empty: in place; else under that name.
    std::optional<std::filesystem::path> wanted_save_;
    double stroke_progress_s_ = 0.0;  ///< when the last of its bricks came
    uint64_t stroke_uploads_ = 0;
    std::string unpainted_;        ///< why a part of the stroke before the save was not painted
    std::string save_failure_;     ///< of the last save; empty: it went well
    Work::Saved saved_;            ///< by the last save
    bool has_tried_view_ = false;  ///< that alone is no reason to stay
    /// Steps that could be undone when the work was discarded: as long as nothing else is done, nothing is saved.
    std::optional<size_t> discarded_steps_;
    /// Steps that could be undone when the last stroke ended that changed nothing: undo takes that back first.
    std::optional<size_t> steps_at_empty_stroke_;
    bool is_leaving_ = false;         ///< that a save fails is a reason to stay
    std::set<Jobs::Number> copies_;   ///< being written by a saver
    std::set<Jobs::Number> writers_;  ///< jobs that write what somebody asked for: leaving waits for them
    bool told_of_writers_ = false;
    bool reopens_when_saved_ = false;  ///< with the spacing of the session
    std::vector<std::string> recovered_;
    std::unique_ptr<Candidate> candidate_;
    std::string open_failure_;
    std::filesystem::path failed_path_;
    Attempt saving_, touching_, recording_, keeping_, painting_, previewing_, looking_, reading_turn_, photographing_;
    std::vector<std::string> logged_instead_;  ///< of the action under way: what replays it whatever is seen by then
    std::optional<Pointer> pointer_;
    std::string clipboard_;
    Reading reading_;
    std::optional<glm::dvec3> read_voxel_;  ///< whole numbers: of which `reading_` has the intensity
    uint64_t read_revision_ = 0;            ///< of the paint
    double read_again_s_ = 0.0;             ///< reading may take long: not before

    glm::uvec2 pixels_{0};
    double units_ = 1.0;
    bool look_is_stale_ = true, camera_moved_ = false;
    bool is_hand_down_ = false, is_still_ = true;
    bool settings_to_record_ = false, was_set_in_this_turn_ = false;
    std::optional<double> to_keep_since_s_;       ///< since when the journal does not hold the view as it is
    double last_change_s_ = 0.0;                  ///< of what is to be kept
    std::optional<Session> session_before_hand_;  ///< as it was before the hand began to set something
    std::unique_ptr<DeviceWatch> watch_;          ///< null: no device is looked for
    std::shared_ptr<HapticDevice> device_;        ///< null: none is open
    HandView hand_;
    std::set<std::string> refused_;  ///< ids of devices that could not be opened, until they are asked for again
    bool is_given_device_ = false;   ///< by the caller
    double look_again_s_ = 0.0, puck_at_s_ = 0.0;
    std::optional<Grab> grab_;
    uint32_t buttons_ = 0;  ///< of a stylus, as they were in the last turn
    double buttons_at_s_ = 0.0;
    glm::dvec3 followed_voxel_{0.0};    ///< the probe's place that the slices have followed
    glm::dvec3 stroke_end_voxel_{0.0};  ///< where an open stroke was extended to
    std::string journal_failure_;       ///< as last reported
    std::optional<int64_t> previewed_at_stroke_;
    bool shows_help_ = false, shows_messages_ = false, shows_passes_ = false, shows_palette_ = false,
         is_full_screen_ = false, quits_ = false;
    bool asks_what_to_open_ = false, shows_preferences_ = false;
    std::string focus_;  ///< what the keyboard was asked to be given to
    std::optional<PassRun> compared_passes_;
    double cut_shown_until_s_ = 0.0;
    double opened_s_ = 0.0;
    uint64_t openings_ = 0;
    /// What a model refers to where nothing is open.
    struct Nothing;
    std::unique_ptr<Nothing> nothing_;
};

}  // namespace shvr::ui
