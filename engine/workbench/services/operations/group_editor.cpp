#include "engine/workbench/services/operations/group_editor.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/annotation/work/work_offsets.h"
#include "engine/base/text.h"

namespace shvr::ui {

/// A copy of the data that a job reads, made when the action arrives, so that later changes do not affect the job.
struct GroupEditor::Snapshot {
    Mask mask;
    TraceGraph trace;
    VolumeInfo volume;
    DensityField density;
    std::shared_ptr<const VolumeSource> source;
    GroupSet locked;
    uint64_t memory = 0;
};

void GroupEditor::begin(const GroupOperation& operation)
{
    const Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_running()) fail("a stroke is being painted; expected it to have ended");
    others_.record_settings();
    const shvr::Document& annotation = annotator.document();
    auto snapshot = std::make_shared<Snapshot>(
        Snapshot{annotation.mask, annotation.trace, document_->volume(), annotation.density, document_->source,
                 locked_groups(document_->session.groups), renderer_.host_budget()});
    is_done_ = false;
    const uint64_t revision = annotator.revision(), opening = desk_.openings;
    running_ =
        jobs_.start(label_of(operation),
                    [this, operation, snapshot, revision, opening](ProgressReporter& reporter) -> Jobs::Completion {
                        const Progress progress = reporter.begin(label_of(operation));
                        const std::shared_ptr<const VolumeSource> source =
                            needs_intensities(operation) ? with_offsets(snapshot->source, snapshot->density) : nullptr;
                        auto result = std::make_shared<OperationResult>(run(operation,
                                                                            {.mask = snapshot->mask,
                                                                             .volume = snapshot->volume,
                                                                             .source = source.get(),
                                                                             .trace = &snapshot->trace,
                                                                             .locked = snapshot->locked,
                                                                             .memory = snapshot->memory},
                                                                            progress));
                        return [this, operation, revision, opening, result] {
                            if (!document_ || desk_.openings != opening)
                                fail(row_of(operation).title, ": the volume is no longer open");
                            end(operation, revision, std::move(*result));
                        };
                    });
}

void GroupEditor::end(const GroupOperation& operation, uint64_t revision, OperationResult result)
{
    Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_running() || annotator.revision() != revision)
        fail(row_of(operation).title,
             ": the annotation was changed while this was computed, so nothing was done; repeat it");
    others_.record_settings();
    std::vector<Change> changes = as_changes(std::exchange(result.changes, {}));
    std::ranges::move(as_changes(result.trace_changes), std::back_inserter(changes));
    const Command* const command = annotator.perform(label_of(operation), std::move(changes));
    if (command) others_.show_changes(*command);
    last_ = std::move(result);
    is_done_ = true;
    say(sentence_of(last_, row_of(operation).title,
                    [&](uint8_t group) { return group_of(document_->session.groups, group).name; }),
        command && last_.kept_locked.empty() ? Weight::done : Weight::warning);
}

const OperationResult& GroupEditor::finish(const Progress& progress)
{
    const uint64_t told_before = desk_.messages.count();
    while (!jobs_.is_idle()) {
        const std::vector<Jobs::State> states = jobs_.states();
        const auto state = std::ranges::find(states, running_, &Jobs::State::number);
        try {
            tell(progress, state == states.end() ? 1.0 : std::max(state->fraction, 0.0));
        } catch (...) {
            jobs_.cancel(running_);
            static_cast<void>(jobs_.wait());
            throw;
        }
        others_.advance_jobs();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    others_.advance_jobs();
    if (is_done_) return last_;
    const Message* const error = desk_.messages.first_after(told_before, Weight::error);
    fail(error ? error->text : "the operation was cancelled");
}

}  // namespace shvr::ui
