#pragma once
// Opening in the background:
//
//   worker      session, statistics, coarser levels, saved work     -> Document::Read
//   main        what is open is saved (saver.cpp)
//   main        the volume goes onto the device in slices           -> Scene
//   main        the document takes the place of the one before
//
// Until the last step what is open stays in use. Where the device has no room for both it is put away while the next
// one is loaded, and comes back where that fails or is cancelled.

#include <exception>

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class FileTaker;
class Painter;
class Photographer;
class PreferenceKeeper;
class Reader;
class Reloader;
class Saver;
struct Services;
class SettingsEditor;
class TaskRunner;
class Viewer;

class Opener : public Service {
public:
    /// Seconds of a step that loading slices of a volume may take.
    static constexpr double SLICE_S = 0.005;

    explicit Opener(Services& all);
    ~Opener() override;
    void act(const DismissNotices& action);

    void advance() override;
    bool advances_without_document() const override { return true; }
    /// With settings as --set takes them. `taken_into_it`: annotation that was dropped with it.
    void begin_open(const std::filesystem::path& path, const std::vector<std::string>& settings,
                    std::vector<std::filesystem::path> taken_into_it = {});
    /// The same, and waits until it is there; saves nothing before. Fails where it cannot be opened.
    void open(const std::filesystem::path& path, const std::vector<std::string>& settings, Work::Opening how);
    /// Takes what the caller has opened; the renderer's scene is of its volume.
    void take(Document::Read read);
    bool is_opening() const { return opening_ != nullptr; }
    /// What is being opened; empty: nothing.
    std::string_view opening_name() const;
    /// Of the job that reads, and of the opening afterwards; 0: nothing is being opened.
    Jobs::Number number() const;
    void cancel();
    /// The job that reads has failed, in words.
    void end_reading(const std::string& failure);
    /// States of what is opened: while it is loaded or comes back, and where `states` lacks its job, which has ended.
    void add_loading(std::vector<Jobs::State>& states) const;
    void add_read(std::vector<Jobs::State>& states) const;
    /// Puts the document away while the device has room for one only.
    void put_away();
    /// Loads what was put away once more.
    void bring_back();
    /// After the graphics device was lost (Workbench::restart_device).
    void restart_device(const std::function<void()>& make_anew);
    OpeningModel model() const;

private:
    struct Opening;
    void start(Opening next);
    void read_next();
    bool is_ready_to_load();
    void begin_loading();
    void finish();
    void show_again();
    void begin_document(const Opening& opening);
    void welcome(const std::filesystem::path& path, const std::vector<std::string>& losses);
    void show_picture(const Session& pictured);
    void end(std::exception_ptr failure);
    void load_again();
    Jobs::State state_of(const Opening& opening) const;

    FileTaker& taker_;
    Painter& painter_;
    Photographer& photographer_;
    PreferenceKeeper& keeper_;
    Reader& reader_;
    Reloader& reloader_;
    Saver& saver_;
    SettingsEditor& settings_;
    TaskRunner& tasks_;
    Viewer& viewer_;
    std::shared_ptr<Opening> opening_;                     ///< null: nothing is being opened
    std::shared_ptr<std::exception_ptr> awaited_failure_;  ///< where `open` waits for what ends an opening
    Jobs::Number next_return_ = Jobs::Number{1} << 48;     ///< so that it is no job's
    std::unique_ptr<Document> away_;  ///< what was open, without a scene, while the device has room for one only
    std::vector<std::string> recovered_;
    std::string open_failure_;
    std::filesystem::path failed_path_;
};

}  // namespace shvr::ui
