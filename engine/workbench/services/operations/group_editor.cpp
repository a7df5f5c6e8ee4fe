#include "engine/workbench/services/operations/group_editor.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/annotation/work/paint_preview.h"
#include "engine/annotation/work/work_offsets.h"
#include "engine/base/text.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/lists/group_list.h"

namespace shvr::ui {

namespace {

/// A preview is drawn from one bit for each voxel of the box around it: 16 MiB at most.
constexpr int64_t MAX_DRAWN_VOXELS = int64_t{1} << 27;

/// Returns the number of voxels in the smallest box of whole bricks around the changes.
int64_t voxels_around(std::span<const MaskBrickChange> changes, const Mask& mask)
{
    if (changes.empty()) return 0;
    VoxelBox around = mask.box_of(changes.front().brick);
    for (const MaskBrickChange& change : changes) {
        const VoxelBox box = mask.box_of(change.brick);
        around = {glm::min(around.lower, box.lower), glm::max(around.upper, box.upper)};
    }
    const Size3 size = around.size();
    return size.x * size.y * size.z;
}

/// Whether the operation reads the trace, or adds to it.
bool concerns_trace(const GroupOperation& operation)
{
    return std::visit(
        []<class Op>(const Op&) {
            if constexpr (requires { Op::READS_TRACE; })
                return true;
            else if constexpr (requires { Op::ADDS_TRACE; })
                return true;
            else
                return false;
        },
        operation);
}

/// Fails if the line is another action.
GroupOperation read_operation(const std::string& line)
{
    return read_action(line, "preview_operation").visit([&]<class Op>(const Op& op) -> GroupOperation {
        if constexpr (IS_GROUP_OPERATION<Op>)
            return op;
        else
            fail("preview_operation: ", in_quotes(line), " is no operation on groups; expected one, such as grow");
    });
}

}  // namespace

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

GroupEditor::State GroupEditor::present(bool with_trace) const
{
    const Annotator& annotator = document_->annotator;
    State state{
        .opening = desk_.openings, .groups = annotator.revision(), .locked = locked_groups(document_->session.groups)};
    if (with_trace) state.trace = annotator.document().trace.revision();
    return state;
}

GroupEditor::State GroupEditor::present(const GroupOperation& operation) const
{
    return present(concerns_trace(operation));
}

bool GroupEditor::is_present(const State& state) const
{
    return document_ && state == present(state.trace.has_value());
}

std::shared_ptr<GroupEditor::Snapshot> GroupEditor::snapshot() const
{
    const shvr::Document& annotation = document_->annotator.document();
    return std::make_shared<Snapshot>(Snapshot{annotation.mask, annotation.trace, document_->volume(),
                                               annotation.density, document_->source,
                                               locked_groups(document_->session.groups), renderer_.host_budget()});
}

Jobs::Number GroupEditor::compute(const std::string& what, const GroupOperation& operation,
                                  std::function<void(OperationResult)> then)
{
    const auto compute_it = [what, operation, then = std::move(then),
                             from = snapshot()](ProgressReporter& reporter) -> Jobs::Completion {
        const Progress progress = reporter.begin(what);
        const std::shared_ptr<const VolumeSource> source =
            needs_intensities(operation) ? with_offsets(from->source, from->density) : nullptr;
        auto result = std::make_shared<OperationResult>(run(operation,
                                                            {.mask = from->mask,
                                                             .volume = from->volume,
                                                             .source = source.get(),
                                                             .trace = &from->trace,
                                                             .locked = from->locked,
                                                             .memory = from->memory},
                                                            progress));
        return [then, result] { then(std::move(*result)); };
    };
    return jobs_.start(what, compute_it);
}

void GroupEditor::begin(const GroupOperation& operation)
{
    const Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_running()) fail("a stroke is being painted; expected it to have ended");
    const std::vector<Jobs::State> jobs = jobs_.states();
    const auto running = std::ranges::find(jobs, running_, &Jobs::State::number);
    if (running != jobs.end() && !running->is_cancelled)
        fail(row_of(operation).title, ": \"", running->what,
             "\" is still being computed; expected it to have ended: wait for it, or cancel it in the list of jobs");
    end_preview();
    others_.record_settings();
    const uint64_t revision = annotator.revision(), opening = desk_.openings;
    running_ = compute(label_of(operation), operation, [this, operation, revision, opening](OperationResult result) {
        if (!document_ || desk_.openings != opening) fail(row_of(operation).title, ": the volume is no longer open");
        end(operation, revision, std::move(result));
    });
    is_done_ = false;
    applied_ = {.line = std::visit([](const auto& op) { return line_of(Action(op)); }, operation), .is_running = true};
}

std::string GroupEditor::in_words(const GroupOperation& operation, const OperationResult& result, bool is_preview) const
{
    const ResultWords words{.name_of = [&](uint8_t group) { return group_of(document_->session.groups, group).name; },
                            .is_preview = is_preview};
    return sentence_of(result, row_of(operation).title, words);
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
    applied_.is_running = false;
    applied_.left = present(operation);
    say(in_words(operation, last_, false), last_.kept_locked.empty() ? Weight::done : Weight::warning);
}

// ---- Previews

void GroupEditor::act(const PreviewOperation& action)
{
    end_preview();
    if (action.operation.empty()) return;
    const GroupOperation operation = read_operation(action.operation);
    if (!applied_.is_running) applied_ = {};
    // A job that has ended before it was replaced still has its completion run.
    const auto number = std::make_shared<Jobs::Number>(0);
    *number = compute("Preview: " + label_of(operation), operation, [this, operation, number](OperationResult result) {
        if (*number == preview_.job) show(operation, std::move(result));
    });
    preview_ = {.line = action.operation, .words = {}, .is_computing = true, .of = present(operation), .job = *number};
    previewing_.insert(*number);
}

/// Cancels the job, too.
void GroupEditor::end_preview()
{
    for (const Jobs::Number number : previewing_) jobs_.cancel(number);
    preview_ = {};
    if (document_) document_->operation_preview.reset();
}

void GroupEditor::show(const GroupOperation& operation, OperationResult result)
{
    if (!document_ || desk_.openings != preview_.of.opening) return;
    const bool erases = !result.moved.empty() &&
                        std::ranges::all_of(result.moved, [](const auto& each) { return each.first.second == 0; });
    preview_.words = in_words(operation, result, true);
    const Size3 size = document_->volume().size;
    if (result.changes.empty()) return;
    if (voxels_around(result.changes, document_->annotator.document().mask) > MAX_DRAWN_VOXELS) {
        preview_.words += "; the region is too large to be drawn";
        return;
    }
    const std::vector<Change> changes = as_changes(std::exchange(result.changes, {}));
    document_->operation_preview = std::make_shared<PaintPreview>(
        preview_of(changes, size, erases ? PaintPreview::Kind::erase : PaintPreview::Kind::group));
}

bool GroupEditor::ends_preview(const Jobs::Finished& job)
{
    if (job.number == running_ && !job.is_done()) applied_ = {};
    if (previewing_.erase(job.number) == 0) return false;
    if (job.number != preview_.job) return true;  // replaced by another, or no longer wanted
    preview_.is_computing = false;
    preview_.has_failed = !job.is_done();
    if (job.was_cancelled) preview_.words = "the preview was cancelled; any change starts another";
    if (!job.failure.empty()) preview_.words = job.failure;
    return true;
}

OperationModel GroupEditor::model() const
{
    OperationModel model;
    if (!document_) return model;
    if (desk_.openings == preview_.of.opening)
        model = {.previewed = preview_.line,
                 .preview_words = preview_.words,
                 .is_previewing = preview_.is_computing,
                 .is_preview_current = !preview_.line.empty() && !preview_.is_computing && is_present(preview_.of),
                 .has_preview_failed = preview_.has_failed};
    if (applied_.is_running || (!applied_.line.empty() && is_present(applied_.left))) model.applied = applied_.line;
    model.is_applying = applied_.is_running;
    return model;
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
            applied_ = {};
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
