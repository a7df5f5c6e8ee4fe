#pragma once
// Long work in the background: each job computes its result on a worker, and this service uses it. Names and
// folders are also checked by the job, since that needs the disk.

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

    /// Handles jobs that have ended.
    void advance() override;
    bool advances_without_document() const override { return true; }
    /// Returns whether a job is writing files that the user requested; quitting and opening another file wait for it.
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
