#pragma once
// Saving, in place or elsewhere, and leaving. The data is copied at once; the files are written in the background.

#include <set>

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

/// Result of asking whether the open document may be closed (Workbench::leave).
enum class Leave {
    now,
    later,    ///< a save is under way; the program stays usable until it ends
    refused,  ///< the document cannot be saved; `why` is set the first time
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
        Call<bool()> is_writing;  ///< whether a file that the user requested is being written
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

    void advance() override;
    /// Forgets state of the previous document.
    void begin_document();
    bool is_saving() const { return save_ != nullptr || wanted_save_; }
    bool is_copying() const { return !copies_.empty(); }
    /// Handles the end of a job of the worker that writes saves.
    void end(const Jobs::Finished& job);
    Leave leave(std::string& why);
    /// Waits for the save under way. Returns the written parts; fails with the reason if a part could not be written.
    /// If `progress` throws, the save is cancelled.
    Work::Saved finish_save(const Progress& progress = {});
    /// The save under way, if any, ends at its next step; files that are not complete by then stay as they were.
    void cancel_save();
    /// Returns whether Quit was requested, and clears the request.
    bool take_quit() { return std::exchange(quits_, false); }
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
    /// Save to start once the current stroke or save has ended. Empty path: in place; otherwise the new path.
    std::optional<std::filesystem::path> wanted_save_;
    std::string unpainted_;          ///< why part of the stroke before the save was not painted
    std::string save_failure_;       ///< why the last save failed; empty: it succeeded
    Work::Saved saved_;              ///< result of the last save
    bool has_tried_view_ = false;    ///< saving only the view was tried; its failure does not prevent closing
    bool is_leaving_ = false;        ///< leaving was requested; if the save fails, leaving is refused
    std::set<Jobs::Number> copies_;  ///< copies that a saver is writing
    bool told_of_writers_ = false;
    bool reopens_when_saved_ = false;  ///< with the session's new spacing
    bool quits_ = false;
    Attempt saving_;
};

}  // namespace shvr::ui
