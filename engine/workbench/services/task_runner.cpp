#include "engine/workbench/services/task_runner.h"

#include <algorithm>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/remote/address.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/words/task_words.h"

namespace shvr::ui {

namespace {

std::string joined(const std::vector<std::string>& texts, const char* between)
{
    std::string text;
    for (const std::string& each : texts) text += (text.empty() ? "" : between) + each;
    return text;
}

void write_note(const std::filesystem::path& note, const std::string& line)
{
    if (note.empty()) return;
    std::error_code ignored;
    std::filesystem::create_directories(note.parent_path(), ignored);
    try {
        write_file_atomically(note, std::as_bytes(std::span(line)));
    } catch (const Error&) {  // the import matters more
    }
}

void remove_note(const std::filesystem::path& note)
{
    std::error_code ignored;
    if (!note.empty()) std::filesystem::remove(note, ignored);
}

/// Returns the import that a note names; null: there is no note, or none that this version understands.
std::optional<ImportTask> import_in(const std::filesystem::path& note)
{
    try {
        if (!is_there(note)) return std::nullopt;
        const Action action = read_action(read_text(note, int64_t{1} << 16), note.string());
        const ImportTask* const task = action.as<ImportTask>();
        return task ? std::optional(*task) : std::nullopt;
    } catch (const Error&) {
        return std::nullopt;
    }
}

}  // namespace

TaskRunner::TaskRunner(Desk& desk, const PreferenceKeeper& keeper, Others others)
    : Service(desk), keeper_(keeper), others_(std::move(others))
{}

void TaskRunner::advance()
{
    for (const Jobs::Finished& job : savers_.finish()) others_.end_save(job);
    for (const Jobs::Finished& job : jobs_.finish()) {
        const auto writer = writers_.find(job.number);
        const std::string kept = writer == writers_.end() || writer->second->empty() ? "" : "; " + *writer->second;
        const bool is_writer = writer != writers_.end();
        if (is_writer) writers_.erase(writer);
        if (const auto import = imports_.find(job.number); import != imports_.end()) {
            if (job.was_cancelled || !job.failure.empty()) look_at_part(import->second);
            imports_.erase(import);
        }
        if (others_.end_reading(job)) continue;
        if (job.was_cancelled) {
            say("Cancelled: " + job.what + kept, kept.empty() ? Weight::done : Weight::warning);
        } else if (!job.failure.empty()) {
            if (is_writer) others_.stay_open();
            say(job.failure, Weight::error);
        }
    }
}

/// Starts a job that writes files. If cancelled, the job notes which files are left, such as an unfinished import.
template <class Work>
Jobs::Number TaskRunner::start_writing(const std::string& what, Work work)
{
    const auto kept = std::make_shared<std::string>();
    const Jobs::Number number = jobs_.start(what, [work = std::move(work), what, kept](ProgressReporter& reporter) {
        try {
            return work(reporter);
        } catch (const Error& error) {
            const std::string words = error.what();
            const bool is_reporter_s = words.starts_with(what + ": cancelled");  // which knows of nothing kept
            if (reporter.stop_requested() && !is_reporter_s) *kept = words;
            throw;
        }
    });
    writers_.emplace(number, kept);
    return number;
}

void TaskRunner::cancel_all()
{
    jobs_.cancel_all();
}

void TaskRunner::act(const CancelJob& action)
{
    if (others_.cancel(action.number)) return;
    jobs_.cancel(action.number);
    savers_.cancel(action.number);
}

JobModel TaskRunner::model() const
{
    std::vector<Jobs::State> states = savers_.states();
    others_.add_loading(states);
    for (Jobs::State& state : jobs_.states()) states.push_back(std::move(state));
    others_.add_reading(states);
    return {.jobs = std::move(states), .unfinished = unfinished_ ? &*unfinished_ : nullptr};
}

void TaskRunner::act(const ExportTask& task)
{
    ExportTask wanted = task;
    others_.record_settings();
    const Document& document = *document_;
    const shvr::Document& annotation = document.annotator.document();
    const AnnotationView view{.volume = document.volume(),
                              .mask = annotation.mask,
                              .density = annotation.density,
                              .trace = annotation.trace,
                              .groups = document.session.groups,
                              .volume_hash = document.session.volume_hash,
                              .project = document.session.volume_path,
                              .volume_path = document.session.volume_path,
                              .trace_path = document.session.trace_path,
                              .mask_path = document.annotator.work().mask_of_header(),
                              .measurements = document.session.measurements};
    auto snapshot = std::make_shared<AnnotationSnapshot>(view);
    std::vector<std::string> names;
    for (const auto& path :
         {wanted.mask, wanted.offset, wanted.trace, wanted.mesh, wanted.metrics, wanted.surface, wanted.measurements})
        if (!path.empty()) names.push_back(short_name(path));
    if (wanted.labels) names.emplace_back("labels");
    if (wanted.budget_host_mib == 0)
        wanted.budget_host_mib = int64_t(keeper_.preferences().budget_host_mib.value_or(0.0));
    start_writing("exporting " + joined(names, ", "),
                  [this, wanted, snapshot](ProgressReporter& reporter) -> Jobs::Completion {
                      ExportResult result = run(wanted, snapshot->view(), reporter);
                      const double bytes = bytes_of_files(result.written);
                      return [this, bytes, result = std::move(result)] {
                          say(exported_in_words(result.written, bytes) +
                                  (result.left_out.empty() ? "" : "; " + joined(result.left_out, "; ")),
                              result.left_out.empty() ? Weight::done : Weight::warning);
                      };
                  });
}

/// The project is opened once it exists.
void TaskRunner::act(const ImportTask& task)
{
    ImportTask wanted = task;
    wanted.volume = take_query(task.volume.string());
    wanted.program = "shvr view";
    if (wanted.budget_host_mib == 0)
        wanted.budget_host_mib = int64_t(keeper_.preferences().budget_host_mib.value_or(0.0));
    unfinished_.reset();  // this import goes on with it, or it is of another project
    const std::filesystem::path note = note_of_import();
    const std::string line = line_of(wanted);
    const auto import = [this, wanted, note, line](ProgressReporter& reporter) -> Jobs::Completion {
        write_note(note, line);
        const ImportResult result = run(wanted, reporter);
        remove_note(note);
        return [this, project = result.report.project, warnings = result.report.warnings] {
            for (const std::string& warning : warnings) say(warning, Weight::warning);
            others_.open(project);
        };
    };
    imports_.emplace(start_writing("importing " + short_name(wanted.volume), import), wanted);
}

/// Returns the file that names the import under way, for the next run of the program if this one ends early. Empty:
/// there is none.
std::filesystem::path TaskRunner::note_of_import() const
{
    const bool is_kept = !options_.settings.empty() && options_.has_preferences && !options_.is_script;
    return is_kept ? options_.settings / "unfinished_import.json" : std::filesystem::path();
}

void TaskRunner::look_at_part(const ImportTask& task)
{
    jobs_.start("looking at what the import has left", [this, task](ProgressReporter&) -> Jobs::Completion {
        return [this, task, found = unfinished_import(task.project)] {
            unfinished_task_ = task;
            unfinished_ = found;
        };
    });
}

void TaskRunner::look_for_unfinished()
{
    const std::filesystem::path note = note_of_import();
    if (note.empty()) return;
    jobs_.start("looking for an unfinished import", [this, note](ProgressReporter&) -> Jobs::Completion {
        const std::optional<ImportTask> task = import_in(note);
        if (!task) return {};
        const std::optional<UnfinishedImport> found = unfinished_import(task->project);
        if (!found) return {};
        return [this, task, found] {
            if (!imports_.empty() || unfinished_) return;
            unfinished_task_ = *task;
            unfinished_ = found;
        };
    });
}

void TaskRunner::act(const SettleImport& action)
{
    if (action.use == UnfinishedUse::resume) return act(unfinished_task_);
    const std::filesystem::path part = unfinished_ ? unfinished_->part : std::filesystem::path();
    unfinished_.reset();
    const auto settle = [this, note = note_of_import(), project = unfinished_task_.project, part,
                         deletes = action.use == UnfinishedUse::remove](ProgressReporter&) -> Jobs::Completion {
        if (deletes) delete_unfinished_import(project);
        remove_note(note);
        return [this, part, deletes] { say(part.string() + (deletes ? " is deleted" : " is kept")); };
    };
    jobs_.start("deleting " + short_name(part), settle);
}

void TaskRunner::act(const LabelTask& task)
{
    const std::shared_ptr<const VolumeSource> source = document_->source;
    const std::filesystem::path path = document_->session.volume_path;
    const std::string name = document_->volume().name;
    const auto label = [this, task, source, path, name](ProgressReporter& reporter) -> Jobs::Completion {
        check(task, *source, path);
        const LabelResult result = run(task, *source, name, reporter);
        return [this, result, task] {
            for (const std::string& warning : result.warnings) say(warning, Weight::warning);
            say(labelled_in_words(result.counts, task));
        };
    };
    start_writing("labelling " + name, label);
}

void TaskRunner::act(const EvaluateTask& asked)
{
    EvaluateTask task = asked;
    for (std::filesystem::path* const path : {&task.truth_mask, &task.mask, &task.volume})
        *path = take_query(path->string());
    jobs_.start("comparing with the reference", [this, task](ProgressReporter& reporter) -> Jobs::Completion {
        const EvaluateResult result = run(task, reporter);
        return [this, result] {
            for (const std::string& warning : result.warnings) say(warning, Weight::warning);
            say(compared_in_words(result));
        };
    });
}

}  // namespace shvr::ui
