#include "engine/workbench/services/saver.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>

#include "engine/look/camera_motion.h"
#include "engine/workbench/services/painter.h"

namespace shvr::ui {

Saver::Saver(Desk& desk, PreferenceKeeper& keeper, Others others)
    : Service(desk), keeper_(keeper), others_(std::move(others))
{}

void Saver::advance()
{
    attempt(saving_, [this] { follow_save(); });
}

void Saver::begin_document()
{
    has_tried_view_ = is_leaving_ = kept_window_open_ = false;
    save_failure_.clear();
    trouble_.clear();
}

void Saver::act(const SaveOp&)
{
    save_to({});
}

void Saver::act(const SaveAs& action)
{
    if (is_saving()) fail("the work is being saved; expected that to have ended");
    save_to(action.path);
}

/// Requests a save. If a stroke is in progress, ends it; the save begins once the stroke is painted, and contains it.
void Saver::save_to(const std::filesystem::path& path)
{
    Annotator& annotator = document_->annotator;
    others_.extend_stroke();
    if (annotator.stroke_is_open()) annotator.end_stroke();
    others_.note_progress();
    if (!save_ && !annotator.stroke_is_running()) return begin_save_to(path);
    wanted_save_ = path;
    say(save_ ? "Will be saved again after the running save" : "Saved when the stroke that is under way is painted");
}

void Saver::follow_save()
{
    if (!wanted_save_ || save_) return;
    Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_running()) {
        renderer_.scene().advance();                              // the stroke needs bricks even if no picture is drawn
        if (annotator.stroke_is_open()) others_.note_progress();  // a hand may rest
        if (!others_.is_stuck()) return;
        annotator.drop_strokes();
        unpainted_ = Painter::why_stuck();
    }
    begin_save_to(*std::exchange(wanted_save_, std::nullopt));
}

void Saver::begin_save_to(const std::filesystem::path& path)
{
    if (!path.empty()) return begin_save_as(path);
    begin_save(true, options_.is_script ? Document::Parts::work : Document::Parts::all);
}

void Saver::begin_save(bool is_asked_for, Document::Parts parts)
{
    if (parts == Document::Parts::all) others_.record_settings();
    start_saving(document_->begin_save(parts), is_asked_for);
}

void Saver::begin_save_as(const std::filesystem::path& path)
{
    others_.record_settings();
    start_saving(document_->begin_save_as(path), true);
    say("Saving as " + path.string() + "; until that ends, nothing can be painted, traced or undone");
}

void Saver::start_saving(std::shared_ptr<Document::Saving> saving, bool is_asked_for)
{
    save_failure_.clear();
    save_ = std::make_unique<Save>(Save{.saving = saving, .is_asked_for = is_asked_for});
    save_->number = savers_.start("saving " + short_name(document_->session_path),
                                  [saving](ProgressReporter& reporter) -> Jobs::Completion {
                                      saving->write(reporter);
                                      return {};
                                  });
}

void Saver::act(const CopySession& action)
{
    start_copy(action.path, false);
}

void Saver::act(const WorkOnCopy& action)
{
    start_copy(action.path, true);
}

/// Starts writing a copy of the current state. Later changes are not in the copy.
void Saver::start_copy(const std::filesystem::path& path, bool opens_it)
{
    if (!document_->only_looks()) others_.record_settings();
    const std::function<std::filesystem::path()> copy = document_->copier(path);
    const std::string name = short_name(document_->session_path);
    copies_.insert(
        savers_.start("copying " + name, [this, copy, opens_it, name](ProgressReporter& reporter) -> Jobs::Completion {
            static_cast<void>(reporter.begin("writing a copy of " + name));
            const std::filesystem::path copied = copy();
            return [this, copied, opens_it] {
                if (opens_it) return others_.begin_open(copied);
                say("Copied to " + copied.string() + "; this window goes on with " + document_->shown_name());
            };
        }));
}

void Saver::end(const Jobs::Finished& job)
{
    if (copies_.erase(job.number) > 0 && job.was_cancelled) say("Cancelled: " + job.what);
    end_save(job);
}

void Saver::end_save(const Jobs::Finished& job)
{
    if (!save_ || save_->number != job.number) {
        if (!job.failure.empty()) say(job.failure, Weight::error);
        return;
    }
    const std::unique_ptr<Save> save = std::move(save_);
    std::string kept;
    saved_ = document_->end_save(*save->saving);
    for (const Notice& notice : saved_.notices) kept += "; " + notice.text;
    std::string unpainted = std::exchange(unpainted_, {});
    if (!unpainted.empty()) unpainted = "; the rest of the stroke was not painted: " + unpainted;
    if (!save->saving->is_written()) {
        save_failure_ = job.was_cancelled ? "the save was cancelled" : job.failure;
        reopens_when_saved_ = false;
        if (!save->is_asked_for) return;
        if (!job.was_cancelled) trouble_ = save_failure_;
        const std::string rest = unpainted + kept + "; what was not saved is in the journal";
        return job.was_cancelled ? say("Cancelled: " + job.what + rest, Weight::warning)
                                 : say(job.failure + unpainted + kept, Weight::error);
    }
    trouble_.clear();
    document_->unsavable.clear();
    kept_window_open_ = false;
    if (save->saving->is_under_another_name()) {
        others_.look_again();
        keeper_.note_opened(document_->session_path);
        return say("Saved as " + document_->session_path.string() + unpainted + kept);
    }
    if (std::exchange(reopens_when_saved_, false)) others_.begin_open(document_->session_path);
    if (!save->is_asked_for && kept.empty()) return;
    const Session& session = document_->session;
    const bool has_trace = !session.trace_path.empty() && !document_->annotator.document().trace.nodes().empty();
    const bool is_behind = document_->annotator.work().unsaved() > 0;
    const std::filesystem::path& mask = saved_.files.empty() ? session.mask_path : saved_.files.front();
    say("Saved " + mask.string() + (has_trace ? ", " + session.trace_path.string() : std::string()) + " and " +
        document_->session_path.string() + unpainted + kept +
        (is_behind ? "; what was done since the save began is not in it" : ""));
}

Leave Saver::close(std::string& why)
{
    waits_to_close_ = others_.is_writing();
    return leave(why);
}

Leave Saver::leave(std::string& why)
{
    if (others_.is_writing()) {
        if (!std::exchange(told_of_writers_, true))
            say("Waiting until the current file is written; cancel that to continue now");
        return Leave::later;
    }
    if (!document_) return savers_.is_idle() ? Leave::now : Leave::later;
    if (is_saving() || !savers_.is_idle()) {
        is_leaving_ = true;
        return Leave::later;
    }
    if (std::exchange(is_leaving_, false) && !save_failure_.empty()) {
        why = std::exchange(save_failure_, {});
        return Leave::refused;
    }
    const bool asks = !document_->annotator.work().disputes().empty();
    const bool is_running = document_->annotator.stroke_is_running();
    try {
        if (document_->only_looks() || others_.is_discarded()) return Leave::now;
        if (asks && !document_->has_settings_to_save()) return Leave::now;
        if (!asks && document_->is_saved() && !is_running) {
            if (!document_->has_view_to_keep() || std::exchange(has_tried_view_, true)) return Leave::now;
            begin_save(false, Document::Parts::session);  // no message if this fails, since only the view is unsaved
            return Leave::later;
        }
        if (asks)
            begin_save(false, Document::Parts::session);
        else
            act(SaveOp{});
    } catch (const std::exception& error) {
        why = error.what();
        return Leave::refused;
    }
    has_tried_view_ = false;
    is_leaving_ = true;
    return Leave::later;
}

void Saver::note_kept_open(const std::string& why)
{
    kept_window_open_ = true;
    if (trouble_.empty()) trouble_ = why;
}

Work::Saved Saver::finish_save(const Progress& progress)
{
    std::exception_ptr stop;
    while (is_saving()) {
        others_.advance_jobs();
        follow_save();
        try {
            for (const Jobs::State& job : savers_.states())
                if (save_ && job.number == save_->number && !stop) tell(progress, std::max(job.fraction, 0.0));
        } catch (...) {
            stop = std::current_exception();
            cancel_save();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (stop && !save_failure_.empty()) std::rethrow_exception(stop);
    if (!save_failure_.empty()) fail(save_failure_);
    return saved_;
}

void Saver::cancel_save()
{
    if (save_) savers_.cancel(save_->number);
}

void Saver::act(const Quit& action)
{
    if (!action.saves) others_.discard();
    quits_ = true;
}

void Saver::act(const StayOpen&)
{
    stay_open();
    say("The window stays open");
}

void Saver::stay_open()
{
    if (!waits_to_close_) return;
    waits_to_close_ = quits_ = told_of_writers_ = false;
    stays_open_ = true;
}

// ---- The spacing ----------------------------------------------------------------------------------------------------

/// Saves the new spacing in the session, then opens the session again, which converts positions in the journal.
void Saver::act(const CorrectSpacing& action)
{
    if (is_saving()) fail("the work is being saved; expected that to have ended");
    Session& session = document_->session;
    Camera& camera = document_->camera;
    const Session before = session;
    const Camera view = camera;
    const glm::dvec3 ratio = action.spacing / document_->volume().spacing;
    camera = respaced(camera, ratio);
    for (auto& [name, kept] : session.cameras)  // the others follow the volume
        if (Camera* const placed = std::get_if<Camera>(&kept)) *placed = respaced(*placed, ratio);
    if (session.raw_layout) {
        session.raw_layout->spacing = action.spacing;
        if (!action.unit.empty()) session.raw_layout->unit = action.unit;
    } else {
        session.open_options.spacing = action.spacing;
        if (!action.unit.empty()) session.open_options.unit = action.unit;
    }
    try {
        if (const std::string unpainted = others_.finish_stroke(); !unpainted.empty()) say(unpainted, Weight::error);
        begin_save(true);
    } catch (...) {
        session = before;
        camera = view;
        throw;
    }
    reopens_when_saved_ = true;
}

SaveModel Saver::model() const
{
    const bool waits_to_close = waits_to_close_ && others_.is_writing();
    if (!document_) return {.waits_to_close = waits_to_close};
    const Work& work = document_->annotator.work();
    SaveModel model{.is_saved = document_->is_saved(),
                    .is_saving = is_saving(),
                    .is_saving_as = work.is_saving_as(),
                    .disputes = work.disputes(),
                    .trouble = work.journal().failure,
                    .waits_to_close = waits_to_close};
    if (document_->only_looks()) return model;  // another notice says so
    if (model.trouble.empty()) model.trouble = trouble_;
    model.is_trouble_of_folder = !document_->unsavable.empty();
    if (model.trouble.empty()) model.trouble = document_->unsavable;
    if (model.trouble.empty()) return model;
    model.is_kept = document_->work_is_saved() || work.is_kept();
    model.kept_window_open = kept_window_open_;
    return model;
}

}  // namespace shvr::ui
