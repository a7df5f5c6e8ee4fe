#pragma once
// Opens, describes or takes files, also those dropped onto the window. Their contents decide their kind.

#include "engine/tasks/file_content.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Opener;
struct Services;
class SettingsEditor;

class FileTaker : public Service {
public:
    explicit FileTaker(Services& all);
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

    Opener& opener_;
    SettingsEditor& settings_;
    std::unique_ptr<Candidate> candidate_;
    std::optional<UnclearFile> unclear_;
};

}  // namespace shvr::ui
