#pragma once
// Saves the document, in place or elsewhere, also before it closes. Copies its data at once; a worker writes the files.

#include <set>

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

/// Result of asking whether the open document may be closed (Workbench::leave).
enum class Leave {
    now,
    later,    ///< a save is in progress; the program stays usable, and asks again later
    refused,  ///< the document cannot be saved; `why` states the reason, but only once
};

class Saver : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void(const std::filesystem::path&)> begin_open;
        Call<void()> extend_stroke;
        Call<std::string()> finish_stroke;
        Call<bool()> is_stuck;
        Call<void()> note_progress;
        Call<bool()> is_writing;  ///< returns whether a job is writing a file that the user requested
        Call<void()> record_settings;
        Call<void()> discard;
        Call<bool()> is_discarded;
        Call<void()> advance_jobs;
        Call<void()> look_again;
    };
    Saver(Desk& desk, PreferenceKeeper& keeper, Others others);
    void act(const SaveOp& action);
    void act(const SaveAs& action);
    void act(const CopySession& action);
    void act(const WorkOnCopy& action);
    void act(const CorrectSpacing& action);
    void act(const Quit& action);
    void act(const StayOpen& action);

    void advance() override;
    /// Forgets state of the previous document.
    void begin_document();
    bool is_saving() const { return save_ != nullptr || wanted_save_; }
    bool is_copying() const { return !copies_.empty(); }
    /// Handles a finished job of the worker thread that writes saves.
    void end(const Jobs::Finished& job);
    Leave leave(std::string& why);
    /// The same for the window: while closing it waits until a file is written, the model says so.
    Leave close(std::string& why);
    /// Takes back the wish to close the window, if that waits: what it waits for has failed, or ended otherwise.
    void stay_open();
    /// Notes that the window was to be closed, and stays open since work cannot be saved; the model says so until a
    /// save succeeds.
    void note_kept_open(const std::string& why);
    /// Waits for the save in progress. Returns the written parts. Fails with the reason if a part could not be written.
    /// An exception from `progress` cancels the save.
    Work::Saved finish_save(const Progress& progress = {});
    /// Stops the save in progress, if any, at its next step. Files that are not complete by then keep their content.
    void cancel_save();
    /// Returns whether Quit was requested, and clears the request.
    bool take_quit() { return std::exchange(quits_, false); }
    /// Returns whether StayOpen was requested, and clears the request.
    bool take_stay_open() { return std::exchange(stays_open_, false); }
    SaveModel model() const;

private:
    void follow_save();
    void save_to(const std::filesystem::path& path);
    void begin_save(bool is_asked_for, Document::Parts parts = Document::Parts::all);
    void begin_save_as(const std::filesystem::path& path);
    void begin_save_to(const std::filesystem::path& path);
    void start_saving(std::shared_ptr<Document::Saving> saving, bool is_asked_for);
    void start_copy(const std::filesystem::path& path, bool opens_it);
    void end_save(const Jobs::Finished& job);

    PreferenceKeeper& keeper_;
    const Others others_;
    /// The save under way.
    struct Save {
        Jobs::Number number = 0;
        std::shared_ptr<Document::Saving> saving;
        bool is_asked_for = true;  ///< false: success is not reported
    };
    std::unique_ptr<Save> save_;
    /// The next save, which starts once the stroke or save in progress has ended. Empty path: a save in place.
    std::optional<std::filesystem::path> wanted_save_;
    std::string unpainted_;     ///< why part of the stroke before the save could not be painted
    std::string save_failure_;  ///< why the last save failed; empty if it succeeded
    std::string trouble_;       ///< the same, until a save succeeds or another document is open
    bool kept_window_open_ = false;
    Work::Saved saved_;              ///< result of the last save
    bool has_tried_view_ = false;    ///< the view was saved, or could not be; the document may be closed
    bool is_leaving_ = false;        ///< the user wants to leave; if the save fails, leaving is refused
    std::set<Jobs::Number> copies_;  ///< copies that a saver is writing
    bool told_of_writers_ = false;
    bool reopens_when_saved_ = false;  ///< with the session's new spacing
    bool quits_ = false, stays_open_ = false;
    bool waits_to_close_ = false;  ///< as in SaveModel
    Attempt saving_;
};

}  // namespace shvr::ui
