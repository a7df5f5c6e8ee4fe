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

    /// Carries out an action. If it fails, nothing has changed, and the caller reports the reason.
    void perform(const Action& action);
    /// Carries out an action; a failure other than DeviceLost becomes a message. Returns whether it succeeded.
    bool apply(const Action& action);
    /// Opens a file in the background, as the action Open does, with settings as --set takes them. The open document is
    /// saved first, and stays until the next one is loaded. A failure becomes a message.
    void begin_open(const std::filesystem::path& path, const std::vector<std::string>& settings)
    {
        services_.opener.begin_open(path, settings);
    }
    /// Opens a file and waits until it is open; does not save the open document first. Fails if it cannot be opened.
    void open(const std::filesystem::path& path, const std::vector<std::string>& settings, Work::Opening how = {})
    {
        services_.opener.open(path, settings, std::move(how));
    }
    /// Takes a document that the caller has opened; the renderer's scene shows the document's volume.
    void take(Document::Read read) { services_.opener.take(std::move(read)); }
    void say(std::string text, Weight weight = Weight::done) { desk_.say(std::move(text), weight); }
    /// Call after the graphics device was lost (DeviceLost, from any function here): drops the workbench's objects on
    /// that device, calls `make_anew`, and displays everything again. Recorded work survives; the part of a running
    /// stroke that is not painted yet is lost.
    void restart_device(const std::function<void()>& make_anew) { services_.opener.restart_device(make_anew); }
    /// From now on this device moves the probe, whatever is plugged in, and its button paints.
    void use_device(std::shared_ptr<HapticDevice> device, const std::string& name)
    {
        services_.hand.use_device(std::move(device), name);
    }
    /// Sets a function that is called with each action carried out, as a line that replays it (actions/action_rows.h).
    void log_to(std::function<void(const std::string& line)> log) { desk_.log = std::move(log); }

    // ---- Steps of the main loop

    /// Sets the size of the picture; 0, 0: no picture is drawn.
    void set_pixels(const glm::uvec2& pixels);
    /// Sets the mouse position, at which values are read; null: the mouse is not over the picture.
    void set_pointer(const std::optional<Pointer>& pointer) { services_.viewer.set_pointer(pointer); }
    /// Returns the text copied since the last call, for the clipboard; empty: none.
    std::string take_clipboard() { return services_.reader.take_clipboard(); }
    /// Sets whether the hand is changing a setting: until it stops, no history step is made, so one drag is one step.
    void set_hand_down(bool is_down) { services_.settings.set_hand_down(is_down); }
    /// Sets the pixels per unit of the interface, for drawing over pictures.
    void set_units(double units) { services_.photographer.set_units(units); }
    /// Sets whether the device is idle; while it is idle, large screenshots may continue.
    void set_still(bool is_still) { services_.photographer.set_still(is_still); }
    /// Runs one step of all background work. A failure becomes a message, and the failed part is retried a little
    /// later; the other parts continue, and no work is lost. Throws DeviceLost.
    void advance();
    /// Runs steps until the current stroke is painted. Returns why part of it was not painted; empty if all of it was.
    std::string finish_stroke() { return services_.painter.finish_stroke(); }
    /// Waits for the save under way. Returns the written parts; fails with the reason if one could not be written. If
    /// `progress` throws, the save is cancelled.
    Work::Saved finish_save(const Progress& progress = {}) { return services_.saver.finish_save(progress); }
    /// The save under way, if any, ends at its next step; files that are not complete by then stay as they were.
    void cancel_save() { services_.saver.cancel_save(); }
    /// Waits for the operation on groups under way; fails with the reason if it did not become a step. If `progress`
    /// throws, the operation is cancelled.
    const OperationResult& finish_operation(const Progress& progress = {}) { return services_.groups.finish(progress); }
    /// Waits until all changes are in the journal on disk; fails with the reason if that is not possible.
    void flush() { desk_.document->annotator.work().flush(); }
    /// Returns whether another step would find work at once.
    bool has_work() const;
    /// Returns whether the journal lacks changes of the view, the probe or the like.
    bool has_view_to_keep() const { return services_.settings.has_view_to_keep(); }
    /// Returns whether a picture exists that does not yet show the last changes.
    bool is_stirring() const { return services_.viewer.is_stirring(); }
    /// Returns whether the open document may be closed: call it once a frame. Saves all work as Save does; if the user
    /// only looked around, saves the view silently. Does not save read-only work; a message has already told the user
    /// so. While the user has not yet decided which files to believe, annotation stays as in the journal.
    using Leave = ui::Leave;
    Leave leave(std::string& why) { return services_.saver.leave(why); }
    bool is_saving() const { return services_.saver.is_saving(); }
    /// Cancels what would delay closing: opening, imports, exports, labelling, comparing. Saves continue.
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
    /// Returns the requested keyboard focus and clears it; empty: none.
    std::string take_focus() { return services_.window.take_focus(); }
    /// Returns the page that the browser is to show, and clears the request; empty: none.
    std::filesystem::path take_page() { return services_.window.take_page(); }
    /// Returns whether the box of the cutting planes is shown: while they are moved, and a little longer.
    bool shows_cut_box() const { return services_.viewer.shows_cut_box(); }
    bool shows_full_screen() const { return services_.window.is_full_screen(); }
    /// Number of voxels in the preview when the last stroke began, if it had one.
    std::optional<int64_t> previewed_at_stroke() const { return services_.painter.previewed_at_stroke(); }
    /// Time when the open document was opened, and the number of documents opened so far.
    double opened_s() const { return desk_.opened_s; }
    uint64_t openings() const { return desk_.openings; }

private:
    void carry_out(const Action& action);

    Desk desk_;
    Services services_{desk_};
    RecentActions recent_;
    /// Services in the order of a step
    const std::array<Service*, 10> turn_{
        &services_.tasks,    &services_.opener,  &services_.reloader, &services_.saver,  &services_.hand,
        &services_.settings, &services_.painter, &services_.viewer,   &services_.reader, &services_.photographer};
};

}  // namespace shvr::ui
