#pragma once
// Operations on whole groups (engine/annotation/operations): a job computes each on a copy of the mask, and its result
// becomes one step of the history. If groups were painted meanwhile, the result no longer fits and is dropped. A
// preview shows the result without applying it, until another action replaces or ends it. Previews and results are
// about a state of the annotation, and say whether that is still there.

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "engine/annotation/operations/run_operation.h"
#include "engine/workbench/actions/group_actions.h"
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
    void act(const PreviewOperation& action);
    /// Takes note of the end of a job. Returns whether the job computed a preview; what it says is shown where the
    /// preview is.
    bool ends_preview(const Jobs::Finished& job);
    OperationModel model() const;
    /// Waits for the operation started last. Fails with the reason if its result did not become a step. An exception
    /// from `progress` cancels the operation.
    const OperationResult& finish(const Progress& progress);

private:
    struct Snapshot;
    /// What a preview or a result is about.
    struct State {
        uint64_t opening = 0, groups = 0;  ///< the document, and the revision of its painted groups
        GroupSet locked{};
        std::optional<uint64_t> trace{};  ///< revision of the trace; null: it does not matter
        bool operator==(const State&) const = default;
    };
    struct Preview {
        std::string line;
        std::string words;  ///< the result, or why there is none
        bool has_failed = false;
        bool is_computing = false;
        State of{};
        Jobs::Number job = 0;
    };
    /// The operation begun last.
    struct Applied {
        std::string line;  ///< empty: it failed, or another one was previewed since
        bool is_running = false;
        State left{};  ///< what it left
    };
    State present(bool with_trace) const;
    State present(const GroupOperation& operation) const;
    bool is_present(const State& state) const;
    std::shared_ptr<Snapshot> snapshot() const;
    /// Computes the operation in a job. `then`, on the main thread, takes the result.
    Jobs::Number compute(const std::string& what, const GroupOperation& operation,
                         std::function<void(OperationResult)> then);
    void end_preview();
    void show(const GroupOperation& operation, OperationResult result);
    std::string in_words(const GroupOperation& operation, const OperationResult& result, bool is_preview) const;
    void begin(const GroupOperation& operation);
    void end(const GroupOperation& operation, uint64_t revision, OperationResult result);

    const Others others_;
    Jobs::Number running_ = 0;
    bool is_done_ = true;
    OperationResult last_;  ///< without its changes
    Preview preview_;
    Applied applied_;
    std::set<Jobs::Number> previewing_;  ///< jobs that compute previews, wanted or cancelled
};

}  // namespace shvr::ui
