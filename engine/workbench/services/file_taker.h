#pragma once
// Opens, describes or takes files, including files dropped onto the window. Decides by content which kind a file is.

#include <deque>
#include <initializer_list>
#include <string_view>

#include "engine/tasks/file_content.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class FileTaker : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void(const std::filesystem::path&)> allow_outside;
        Call<void(const std::filesystem::path& path, const std::vector<std::string>& settings,
                  std::vector<std::filesystem::path> taken_into_it, bool asks)>
            begin_open;  ///< `asks`: if a scan is open and the file looks like a label image, asks first
        Call<void(Session)> take_session;
        Call<void(const Set&)> set;
        Call<void()> record_settings;
        Call<void(const Command&)> show_changes;
    };
    FileTaker(Desk& desk, Others others);
    void act(const Open& action);
    void act(const OpenExample& action);
    void act(const LookAtFile& action);
    void act(const TakeFile& action);
    void act(const LoadAnnotation& action);
    void act(const PreviewLoad& action);
    void act(const DismissUnclearFile& action);
    /// Asks the user what kind of file this is. Fails in a script, where no user can answer.
    void ask_what_it_is(UnclearFile file);

    CandidateModel model() const
    {
        return {.candidate = candidate_.get(),
                .unclear_file = unclear_ ? &*unclear_ : nullptr,
                .load_preview = has_preview() ? &*preview_ : nullptr};
    }

private:
    enum class Step {
        preview,          ///< for the dialog that asked for it
        preview_in_turn,  ///< when the files dropped before it are loaded or left
        load
    };
    struct ReadFile;
    /// A preview ends with the document that it was made for.
    bool has_preview() const;
    void take(FileContent content, const std::filesystem::path& path, Step step);
    void take_as(FileUse use, const std::filesystem::path& path, Step step = Step::load);
    void load_by_contents(const std::filesystem::path& path, Step step);
    void read_transfer_function(const std::filesystem::path& path, Step step);
    void read_mesh_file(const std::filesystem::path& path, Step step);
    void record_loaded(std::initializer_list<std::string_view> sections);
    void add_mesh(const std::filesystem::path& path);
    void read_annotation(Part part, const std::filesystem::path& path, Step step);
    void take_together(std::vector<std::filesystem::path> paths, Step step);
    void go_on_with(std::shared_ptr<const ReadFile> read, Step step);
    std::vector<Change> changes_by(const ReadFile& read) const;
    void show_preview(std::shared_ptr<const ReadFile> read);
    void show_next_preview();
    void refuse_preview(const std::filesystem::path& path, const std::string& why, bool is_unclear = false);
    void start_reading(const std::string& what, const std::filesystem::path& path, Step step, Jobs::Function read);
    void load(const ReadFile& read);
    void load_transfer_function(const ReadFile& read);

    const Others others_;
    std::unique_ptr<Candidate> candidate_;
    std::optional<UnclearFile> unclear_;
    std::optional<LoadPreview> preview_;
    uint64_t preview_opening_ = 0;                            ///< Desk::openings when `preview_` was asked for
    std::shared_ptr<const ReadFile> previewed_;               ///< what `preview_` describes, once it is read
    std::deque<std::shared_ptr<const ReadFile>> to_preview_;  ///< dropped together with that, shown after it
};

}  // namespace shvr::ui
