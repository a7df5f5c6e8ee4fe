#pragma once
// Opening in the background:
//
//   worker      session, statistics, coarser levels, saved work     -> Document::Read
//   main        saves the open document (saver.cpp)
//   main        loads the volume onto the device in slices          -> Scene
//   main        replaces the open document
//
// Until the last step the open document stays in use. If the device has no room for both, the open document is unloaded
// while the next one is loaded, and loaded again if that fails or is cancelled.

#include <exception>
#include <set>

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

enum class Leave;

class Opener : public Service {
public:
    /// Maximum time per main-loop step for loading slices of a volume, in seconds.
    static constexpr double SLICE_S = 0.005;

    /// Functions of other services that it calls.
    struct Others {
        Call<void()> advance_jobs;
        Call<Leave(std::string& why)> leave;
        Call<bool()> is_saving;
        Call<bool()> cancel_reload;  ///< returns whether there was one
        Call<void(const char* by)> drop_screenshot;
        Call<void()> look_again;
        Call<void(const Camera&)> look_from;
        Call<void(const LoadAnnotation&)> load_annotation;
        Call<void(UnclearFile)> ask_what_it_is;
        Call<void()> record_settings;
        Call<void()> begin_document;  ///< resets state of the previous document
    };
    Opener(Desk& desk, PreferenceKeeper& keeper, Others others);
    ~Opener() override;
    void act(const DismissNotices& action);

    void advance() override;
    bool advances_without_document() const override { return true; }
    /// Starts opening a path, with settings as --set takes them. `taken_into_it`: annotation that was dropped with the
    /// path. `asks`: if the file looks like a label image and a document is open, asks the user instead of opening.
    void begin_open(const std::filesystem::path& path, const std::vector<std::string>& settings,
                    std::vector<std::filesystem::path> taken_into_it = {}, bool asks = false);
    /// Permits the session at this path to write outside its folder, until the program ends.
    void allow_outside(const std::filesystem::path& path) { allowed_outside_.insert(path); }
    /// Opens a path and waits until it is open; does not save the open document first. Fails if it cannot be opened.
    void open(const std::filesystem::path& path, const std::vector<std::string>& settings, Work::Opening how);
    /// Opens a document that the caller has read, and whose volume the renderer's scene already has.
    void take(Document::Read read);
    bool is_opening() const { return opening_ != nullptr; }
    /// Returns the name of the file being opened; empty: none.
    std::string_view opening_name() const;
    void cancel();
    /// If the opening has the job number `number`, cancels the opening and returns true.
    bool cancel(Jobs::Number number);
    /// If a finished job is the reading job of the opening, handles the job and returns true.
    bool end_reading(const Jobs::Finished& job);
    /// add_loading: adds the opening if it is loading onto the device. add_read: adds it if its reading job just ended.
    void add_loading(std::vector<Jobs::State>& states) const;
    void add_read(std::vector<Jobs::State>& states) const;
    /// Unloads the open document, to make room on the device for another one.
    void put_away();
    /// Loads the unloaded document onto the device again.
    void bring_back();
    /// Shows everything again after the graphics device was lost (Workbench::restart_device).
    void restart_device(const std::function<void()>& make_anew);
    OpeningModel model() const;

private:
    struct Opening;
    struct ReadResult;
    bool asks_what_it_is();
    void start(Opening next);
    void read_next();
    bool is_ready_to_load();
    void begin_loading();
    void finish();
    void show_again();
    void begin_document(const Opening& opening);
    void welcome(const std::filesystem::path& path, const std::vector<std::string>& losses,
                 const std::vector<std::string>& removed);
    void show_picture(const Session& pictured);
    void end(std::exception_ptr failure);
    void load_again();
    Jobs::State state_of(const Opening& opening) const;

    PreferenceKeeper& keeper_;
    const Others others_;
    std::shared_ptr<Opening> opening_;                     ///< null: nothing is being opened
    std::shared_ptr<std::exception_ptr> awaited_failure_;  ///< failure of the opening for which `open` waits
    Jobs::Number next_return_ = Jobs::Number{1} << 48;     ///< number for the next bring_back(), above all job numbers
    std::unique_ptr<Document> away_;  ///< the open document while the device has no room for it next to another one
    std::set<std::filesystem::path> allowed_outside_;
    std::vector<std::string> recovered_;
    std::string looks_like_labels_;  ///< see OpeningModel
    std::string open_failure_;
    std::filesystem::path failed_path_;
};

}  // namespace shvr::ui
