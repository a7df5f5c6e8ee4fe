#pragma once
// Operations on whole groups (engine/annotation/operations): a job computes each on a copy of the mask, and its result
// becomes one step of the history. If groups were painted meanwhile, the result no longer fits and is dropped.

#include "engine/annotation/operations/run_operation.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class GroupEditor : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void()> record_settings;
        Call<void(const Command&)> show_changes;
        Call<void()> advance_jobs;
    };
    GroupEditor(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

    template <class Operation>
    requires IS_GROUP_OPERATION<Operation>
    void act(const Operation& operation) { begin(GroupOperation(operation)); }
    /// Waits for the operation started last. Fails with the reason if its result did not become a step. An exception
    /// from `progress` cancels the operation.
    const OperationResult& finish(const Progress& progress);

private:
    struct Snapshot;
    void begin(const GroupOperation& operation);
    void end(const GroupOperation& operation, uint64_t revision, OperationResult result);

    const Others others_;
    Jobs::Number running_ = 0;
    bool is_done_ = true;
    OperationResult last_;  ///< without its changes
};

}  // namespace shvr::ui
