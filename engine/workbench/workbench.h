#pragma once
// Everything the user can do, without a window: the open document, the actions on it, background work, and
// messages. The window, scripts and tests are its callers; keys, menus and panels only make
// actions (actions/action.h).
//
//   actions -> perform -> the service that an action's row names -> advance: a step of each service
//
// Runs on one thread, which owns the renderer. Other threads: the servo's (haptics/servo.h), those of jobs and savers,
// and one that writes a screenshot.
// `advance` never waits for the device or a disk: jobs read and write files, and a volume that is opened
// is loaded onto the device in slices of a few milliseconds. A step in which nothing happens costs microseconds
// (ui/MEASURED.md).

#include <array>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/desk/desk.h"
#include "engine/workbench/lists/recent_actions.h"
#include "engine/workbench/services/services.h"

namespace shvr::ui {

class Workbench {
public:
    Workbench(Renderer& renderer, WorkbenchOptions options);
    ~Workbench();
    Workbench(const Workbench&) = delete;

    // ---- Actions

    /// Carries out an action. If it fails, nothing has changed; the caller should report the reason.
    void perform(const Action& action);
    /// Carries out an action. A failure other than DeviceLost becomes a message. Returns whether the action succeeded.
    bool apply(const Action& action);
    /// Opens a file in the background, as the action Open does, with settings as --set takes them. Saves the open
    /// document first, which stays open until the new one is loaded. A failure becomes a message.
    void begin_open(const std::filesystem::path& path, const std::vector<std::string>& settings)
    {
        services_.opener.begin_open(path, settings);
    }
    /// Opens a file and waits until it is open, without saving the open document first. Fails if that is not possible.
    void open(const std::filesystem::path& path, const std::vector<std::string>& settings, Work::Opening how = {})
    {
        services_.opener.open(path, settings, std::move(how));
    }
    /// Opens a document that the caller has read, and whose volume the renderer's scene already has.
    void take(Document::Read read) { services_.opener.take(std::move(read)); }
    void say(std::string text, Weight weight = Weight::done) { desk_.say(std::move(text), weight); }
    /// Call this after any function here threw DeviceLost: drops the workbench's objects on the lost device, calls
    /// `make_anew`, and displays everything again. Recorded work survives; parts of a running stroke that are not
    /// painted yet are lost.
    void restart_device(const std::function<void()>& make_anew) { services_.opener.restart_device(make_anew); }
    /// Makes this device move the probe, whatever other devices are connected; its first button paints.
    void use_device(std::shared_ptr<HapticDevice> device, const std::string& name)
    {
        services_.hand.use_device(std::move(device), name);
    }
    /// Sets a function that receives each action carried out, as a line that replays it (actions/action_rows.h).
    void log_to(std::function<void(const std::string& line)> log) { desk_.log = std::move(log); }

    // ---- Steps of the main loop

    /// Sets the size of the picture in pixels; 0, 0: no picture is drawn.
    void set_pixels(const glm::uvec2& pixels);
    /// Sets the position of the mouse, for reading values there; null: the mouse is not over the picture.
    void set_pointer(const std::optional<Pointer>& pointer) { services_.viewer.set_pointer(pointer); }
    /// Returns the text to put on the clipboard, and clears it; empty: nothing was copied since the last call.
    std::string take_clipboard() { return services_.reader.take_clipboard(); }
    /// Sets whether the user holds a control. Meanwhile, changes of settings make no history step: a drag is one step.
    void set_hand_down(bool is_down) { services_.settings.set_hand_down(is_down); }
    /// Sets the number of pixels per unit of the interface, for lines and labels over pictures.
    void set_units(double units) { services_.photographer.set_units(units); }
    /// Sets whether the device is idle. Large screenshots make progress only while it is.
    void set_still(bool is_still) { services_.photographer.set_still(is_still); }
    /// Runs one step of all background work. If a part fails, the failure becomes a message, and the part is retried a
    /// little later; other parts continue, and no work is lost. Throws DeviceLost.
    void advance();
    /// Runs steps until the current stroke is fully painted. Returns why part of it was not painted; empty: all was.
    std::string finish_stroke() { return services_.painter.finish_stroke(); }
    /// Waits for the save in progress. Returns the parts that were written. Fails with the reason if a part could not
    /// be written. An exception from `progress` cancels the save.
    Work::Saved finish_save(const Progress& progress = {}) { return services_.saver.finish_save(progress); }
    /// Stops the save in progress, if any, at its next step. Files that are not complete by then keep their content.
    void cancel_save() { services_.saver.cancel_save(); }
    /// Waits for the running operation on groups. Fails with the reason if its result did not become a step. An
    /// exception from `progress` cancels the operation.
    const OperationResult& finish_operation(const Progress& progress = {}) { return services_.groups.finish(progress); }
    /// Waits until the journal on disk has all changes. Fails with the reason if they cannot be written.
    void flush() { desk_.document->annotator.work().flush(); }
    /// Returns whether another call of advance() would have work to do at once.
    bool has_work() const;
    /// Returns whether the journal on disk lacks changes of the view, the probe or similar settings.
    bool has_view_to_keep() const { return services_.settings.has_view_to_keep(); }
    /// Returns whether a picture exists that does not show the last changes yet.
    bool is_stirring() const { return services_.viewer.is_stirring(); }
    /// Returns whether the open document may be closed; call this once a frame. Saves all work as Save does; if only
    /// the view changed, saves it without a message. Read-only work is not saved, as a message has told the user
    /// before. While the user has not chosen between journal and changed files, the annotation stays in the journal.
    using Leave = ui::Leave;
    Leave leave(std::string& why) { return services_.saver.close(why); }
    bool is_saving() const { return services_.saver.is_saving(); }
    /// Notes that the window was to be closed, and stays open because of `why`, a reason that `leave` gave.
    void note_kept_open(const std::string& why) { services_.saver.note_kept_open(why); }
    /// Cancels jobs that would delay closing: opening, imports, exports, labelling, comparing. Saves continue.
    void cancel_tasks() { services_.tasks.cancel_all(); }
    /// Returns whether any job is displayed.
    bool shows_jobs() const;

    // ---- What there is to see

    bool is_open() const { return desk_.document != nullptr; }
    const Document& document() const { return *desk_.document; }
    Screen& screen() { return desk_.document->screen; }
    Model model() const;
    std::string why_not(const Action& action) const { return ui::why_not(model(), action); }
    const MessageLog& messages() const { return desk_.messages; }
    bool takes_large_screenshot() const { return services_.photographer.has_large(); }
    void wait_for_screenshots() const { services_.photographer.wait(); }
    /// Returns whether Quit was requested, and clears the request.
    bool take_quit() { return services_.saver.take_quit(); }
    /// Likewise, whether closing the window was taken back.
    bool take_stay_open() { return services_.saver.take_stay_open(); }
    /// Returns the part of the window that should get the keyboard focus, and clears the request; empty: no request.
    std::string take_focus() { return services_.window.take_focus(); }
    /// Returns the page that the browser should open, and clears the request; empty: no request.
    std::filesystem::path take_page() { return services_.window.take_page(); }
    /// Returns whether to show the box of the cutting planes: while they are moved and for a short time afterwards.
    bool shows_cut_box() const { return services_.viewer.shows_cut_box(); }
    bool shows_full_screen() const { return services_.window.is_full_screen(); }
    /// Returns how many voxels the brush's preview showed when the last stroke began; null if no preview was shown.
    std::optional<int64_t> previewed_at_stroke() const { return services_.painter.previewed_at_stroke(); }
    /// opened_s(): when the open document was opened. openings(): how many documents were opened so far.
    double opened_s() const { return desk_.opened_s; }
    uint64_t openings() const { return desk_.openings; }

private:
    void carry_out(const Action& action);

    Desk desk_;
    Services services_{desk_};
    RecentActions recent_;
    /// Services in the order of a step
    const std::array<Service*, 11> turn_{&services_.tasks,    &services_.opener,      &services_.reloader,
                                         &services_.meshes,   &services_.saver,       &services_.hand,
                                         &services_.settings, &services_.painter,     &services_.viewer,
                                         &services_.reader,   &services_.photographer};
};

}  // namespace shvr::ui
