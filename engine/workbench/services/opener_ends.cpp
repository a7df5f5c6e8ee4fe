#include "engine/workbench/services/opener.h"

#include <algorithm>

#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/workbench/services/opening.h"

namespace shvr::ui {

std::string_view Opener::opening_name() const
{
    return opening_ ? std::string_view(opening_->name) : std::string_view();
}

void Opener::add_loading(std::vector<Jobs::State>& states) const
{
    if (opening_ && (opening_->read || opening_->comes_back)) states.push_back(state_of(*opening_));
}

void Opener::add_read(std::vector<Jobs::State>& states) const
{
    // Adds the opening if its reading job has ended but its result has not been used yet.
    if (opening_ && std::ranges::find(states, opening_->number, &Jobs::State::number) == states.end())
        states.push_back(state_of(*opening_));
}

Jobs::State Opener::state_of(const Opening& opening) const
{
    const std::string name = short_name(opening.path);
    return {.number = opening.number,
            .what = "opening " + name,
            .stretch = opening.scene ? "loading " + name + " onto the device" : std::string(),
            .detail = opening.scene ? std::string() : "waits until the work is saved",
            .fraction = opening.scene ? opening.scene->loaded() : -1.0,
            .seconds = options_.now_s() - opening.begun_s};
}

OpeningModel Opener::model() const
{
    return {.recovered = document_ ? std::span<const std::string>(recovered_) : std::span<const std::string>(),
            .opening = opening_name(),
            .open_failure = open_failure_,
            .failed_path = &failed_path_,
            .looks_like_labels = document_ ? std::string_view(looks_like_labels_) : std::string_view()};
}

// ---- Cancellation and failure ---------------------------------------------------------------------------------------

bool Opener::end_reading(const Jobs::Finished& job)
{
    if (!opening_ || opening_->number != job.number) return false;
    if (job.was_cancelled) {
        cancel();
    } else if (!job.failure.empty()) {
        const bool was_thrown = opening_->thrown && *opening_->thrown;
        end(was_thrown ? *opening_->thrown : std::make_exception_ptr(Error(job.failure)));
    }
    return true;
}

bool Opener::cancel(Jobs::Number number)
{
    if (!opening_ || opening_->number != number) return false;
    cancel();
    return true;
}

void Opener::cancel()
{
    if (!opening_) return;
    if (opening_->comes_back) return;  // there is nothing else to be shown
    jobs_.cancel(opening_->number);
    say("Cancelled: opening " + short_name(opening_->path));
    const std::shared_ptr<Opening> ended = std::exchange(opening_, nullptr);
    ended->scene.reset();
    if (away_) bring_back();
}

void Opener::end(std::exception_ptr failure)
{
    const std::shared_ptr<Opening> ended = std::exchange(opening_, nullptr);
    ended->scene.reset();
    others_.look_again();
    std::string why = "an error of an unknown kind";
    try {
        std::rethrow_exception(failure);
    } catch (const std::bad_alloc& error) {
        why = sentence(ended->path.string(), ": ", told_of(error), "; then open it again");
    } catch (const std::exception& error) {
        why = error.what();
    } catch (...) {
    }
    if (ended->comes_back) {
        const std::string path = away_ ? away_->shown_name() : std::string();
        away_.reset();
        return say(sentence(why, "; ", path, " cannot be shown again either; it is saved"), Weight::error);
    }
    if (!ended->taken_into_it.empty()) why += "; what was dropped with it is not taken either";
    if (document_) why += "; " + document_->shown_name() + " stays open";
    open_failure_ = why;
    failed_path_ = ended->path;
    if (awaited_failure_)
        *awaited_failure_ = document_ ? std::make_exception_ptr(Error(why)) : failure;
    else
        say(why, Weight::error);
    if (away_) bring_back();
}

void Opener::put_away()
{
    away_ = std::move(document_);
    away_->touch.use(nullptr);  // a device can have one servo only
}

/// Loads the unloaded document onto the device again.
void Opener::bring_back()
{
    opening_ = std::make_shared<Opening>(Opening{.path = away_->session_path,
                                                 .name = short_name(away_->session_path),
                                                 .begun_s = options_.now_s(),
                                                 .comes_back = true});
    opening_->number = next_return_++;
    const Session& session = away_->session;
    try {
        renderer_.take_scene();
        opening_->scene = renderer_.begin_loading(away_->scene_source, away_->statistics, session.render,
                                                  shows_occlusion(session.light), away_->annotator.document());
    } catch (const DeviceLost&) {
        throw;
    } catch (...) {
        end(std::current_exception());
    }
}

// ---- Loss of the graphics device ------------------------------------------------------------------------------------

void Opener::restart_device(const std::function<void()>& make_anew)
{
    const bool was_painting = document_ && document_->annotator.stroke_is_running();
    others_.drop_screenshot("the loss of the device");
    if (document_) {
        document_->annotator.drop_queries();
        document_->previewer.drop();
        document_->meter.drop();
        document_->touch.drop_queries();
        document_->screen.drop();
    }
    if (opening_) opening_->scene.reset();                            // it is loaded again from its beginning
    const bool was_reloading = document_ && others_.cancel_reload();  // load_again() must not make coarser levels
    make_anew();
    others_.look_again();
    if (document_) load_again();  // or puts it away
    if (away_ && (!opening_ || opening_->comes_back)) bring_back();
    say(sentence("The graphics device stopped responding and was restarted; ",
                 was_painting && !document_ ? "the stroke being painted may be incomplete, all other work is intact"
                                            : "all work is intact",
                 was_reloading ? "; render.sampling and render.paging are again as the volume is loaded" : ""),
        Weight::warning);
}

/// Loads the document onto the new device. If the device cannot hold it, or if the volume is on another machine, for
/// which the window must not wait, unloads it, to be shown again later.
void Opener::load_again()
{
    if (leads_to_network(document_->session.volume_path)) {
        cancel();  // another opening would end with this document still unloaded
        document_->annotator.drop_strokes();
        return put_away();
    }
    try {
        document_->load_again(renderer_);
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        say(sentence("The graphics device was restarted, but ", document_->shown_name(),
                     " cannot be shown on it: ", error.what()),
            Weight::error);
        document_->annotator.drop_strokes();
        put_away();
    }
}

}  // namespace shvr::ui
