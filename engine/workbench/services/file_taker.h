#pragma once
// Opens, describes or takes files, including files dropped onto the window. The contents of a file decide its kind.

#include "engine/tasks/file_content.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class FileTaker : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void(const std::filesystem::path&)> allow_outside;
        Call<void(const std::filesystem::path& path, const std::vector<std::string>& settings,
                  std::vector<std::filesystem::path> taken_into_it)>
            begin_open;
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
    void act(const DismissUnclearFile& action);

    CandidateModel model() const
    {
        return {.candidate = candidate_.get(), .unclear_file = unclear_ ? &*unclear_ : nullptr};
    }

private:
    void take(FileContent content, const std::filesystem::path& path);
    void take_as(FileUse use, const std::filesystem::path& path);
    void take_transfer_function(const std::filesystem::path& path);
    void take_together(std::vector<std::filesystem::path> paths);
    void ask_what_it_is(UnclearFile file);
    void take_annotation(Part part, const std::filesystem::path& path);

    const Others others_;
    std::unique_ptr<Candidate> candidate_;
    std::optional<UnclearFile> unclear_;
};

}  // namespace shvr::ui
