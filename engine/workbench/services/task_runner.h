#pragma once
// Long work in the background: a job computes a result on a worker thread, and this service then uses it. Jobs also
// check file names and folders, since such checks access the disk.

#include <map>
#include <memory>
#include <string>

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class TaskRunner : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void(const Jobs::Finished&)> end_save;
        Call<bool(const Jobs::Finished&)> end_reading;  ///< returns whether the job was the reading job of an opening
        Call<bool(Jobs::Number)> cancel;                ///< cancels another service's job; returns whether it was found
        Call<void(std::vector<Jobs::State>&)> add_loading;
        Call<void(std::vector<Jobs::State>&)> add_reading;
        Call<void(const std::filesystem::path&)> open;
        Call<void()> record_settings;
        Call<void()> stay_open;  ///< takes back the wish to close the window, if that waits for a file
    };
    TaskRunner(Desk& desk, const PreferenceKeeper& keeper, Others others);
    void act(const ExportTask& task);
    void act(const ImportTask& task);
    void act(const LabelTask& task);
    void act(const EvaluateTask& asked);
    void act(const CancelJob& action);
    void act(const SettleImport& action);

    /// Looks, in the background, for what an import has left that ended with an earlier run of the program.
    void look_for_unfinished();
    /// Cancels all jobs, except saves and copies of the work.
    void cancel_all();

    /// Handles jobs that have ended.
    void advance() override;
    bool advances_without_document() const override { return true; }
    /// Returns whether a job is writing files that the user requested. Quitting and opening other files wait for it.
    bool is_writing() const { return !writers_.empty(); }
    JobModel model() const;

private:
    std::filesystem::path note_of_import() const;
    void look_at_part(const ImportTask& task);
    template <class Work>
    Jobs::Number start_writing(const std::string& what, Work work);

    const PreferenceKeeper& keeper_;
    const Others others_;
    /// Jobs that write files, each with a text in which a cancelled job states which files it leaves on the disk.
    std::map<Jobs::Number, std::shared_ptr<const std::string>> writers_;
    std::map<Jobs::Number, ImportTask> imports_;  ///< under way
    ImportTask unfinished_task_;                  ///< the last import that was cancelled, has failed or was interrupted
    std::optional<UnfinishedImport> unfinished_;  ///< what it has left
};

}  // namespace shvr::ui
