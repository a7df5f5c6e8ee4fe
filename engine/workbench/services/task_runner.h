#pragma once
// Long work in the background: each job makes its result on a worker; what is done with it happens here. Names and
// folders are checked by the job, too: that asks the disk.

#include <set>

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class FileTaker;
class Opener;
class Photographer;
class Reloader;
class Saver;
struct Services;
class SettingsEditor;

class TaskRunner : public Service {
public:
    explicit TaskRunner(Services& all);
    void act(const ExportTask& task);
    void act(const ImportTask& task);
    void act(const LabelTask& task);
    void act(const EvaluateTask& task);
    void act(const CancelJob& action);

    /// Ends the jobs that have ended.
    void advance() override;
    bool advances_without_document() const override { return true; }
    /// A job writes files that were asked for: leaving waits for it.
    bool is_writing() const { return !writers_.empty(); }
    JobModel model() const;

private:
    FileTaker& taker_;
    Opener& opener_;
    Photographer& photographer_;
    Reloader& reloader_;
    Saver& saver_;
    SettingsEditor& settings_;
    std::set<Jobs::Number> writers_;
};

}  // namespace shvr::ui
