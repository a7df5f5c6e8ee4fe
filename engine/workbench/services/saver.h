#pragma once
// Saving, in place or elsewhere, and leaving: what is to be written is taken at once, and files are written in the
// background.

#include <set>

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Opener;
class Painter;
class Photographer;
class PreferenceKeeper;
struct Services;
class SettingsEditor;
class TaskRunner;
class Viewer;

/// Whether what is open may be closed (Workbench::leave).
enum class Leave {
    now,
    later,    ///< something is being saved; all can be used meanwhile
    refused,  ///< it cannot be saved; `why` says why, once
};

class Saver : public Service {
public:
    explicit Saver(Services& all);
    void act(const SaveOp& action);
    void act(const SaveAs& action);
    void act(const CopySession& action);
    void act(const WorkOnCopy& action);
    void act(const CorrectSpacing& action);
    void act(const Quit& action);

    void advance() override;
    /// Forgets what was of the document before.
    void begin_document();
    bool is_saving() const { return save_ != nullptr || wanted_save_; }
    bool is_copying() const { return !copies_.empty(); }
    /// A job of the savers has ended.
    void end(const Jobs::Finished& job);
    Leave leave(std::string& why);
    /// Waits for what is being saved. Returns what was written; fails with the reason where that is not all.
    Work::Saved finish_save();
    /// Quit was asked for; asking clears it.
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

    Opener& opener_;
    Painter& painter_;
    Photographer& photographer_;
    PreferenceKeeper& keeper_;
    SettingsEditor& settings_;
    TaskRunner& tasks_;
    Viewer& viewer_;
    /// What is being saved.
    struct Save {
        Jobs::Number number = 0;
        std::shared_ptr<Document::Saving> saving;
        bool is_asked_for = true;  ///< otherwise nothing is said where all goes well
    };
    std::unique_ptr<Save> save_;
    /// Once the stroke, or the save, under way has ended. Empty: in place; else under that name.
    std::optional<std::filesystem::path> wanted_save_;
    std::string unpainted_;          ///< why a part of the stroke before the save was not painted
    std::string save_failure_;       ///< why the last save failed; empty: it went well
    Work::Saved saved_;              ///< by the last save
    bool has_tried_view_ = false;    ///< that alone is no reason to stay
    bool is_leaving_ = false;        ///< that a save fails is a reason to stay
    std::set<Jobs::Number> copies_;  ///< being written by a saver
    bool told_of_writers_ = false;
    bool reopens_when_saved_ = false;  ///< with the spacing of the session
    bool quits_ = false;
    Attempt saving_;
};

}  // namespace shvr::ui
