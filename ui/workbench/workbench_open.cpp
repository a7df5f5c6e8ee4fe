// Opening, beside the work:
//
//   worker      session, statistics, coarser levels, saved work     -> Document::Read
//   main        what is open is saved (workbench_save.cpp)
//   main        the volume goes onto the device in slices           -> Scene
//   main        the document takes the place of the one before
//
// Until the last step what is open stays in use. Where the device has no room for both it is put away while the next
// one is loaded, and comes back where that fails or is cancelled.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <thread>
#include <utility>

#include "engine/base/assets.h"
#include "engine/base/text.h"
#include "engine/session/picture_session.h"
#include "engine/session/session_keys.h"
#include "engine/session/session_patch.h"
#include "haptics/devices/device_list.h"
#include "haptics/hid/hid_profile.h"
#include "ui/workbench/workbench.h"

namespace shvr::ui {

namespace {

bool is_one_journal(const std::filesystem::path& a, const std::filesystem::path& b)
{
    return std::filesystem::absolute(a).lexically_normal() == std::filesystem::absolute(b).lexically_normal();
}

/// What is opened for a picture: the project it was made of, or the bare volume. Empty where it is no picture, or one
/// of bare voxels, which only its session describes.
std::filesystem::path opened_for_picture(const std::filesystem::path& path, const OpenedSession& opened)
{
    std::error_code ignored;
    if (!session_file_of(path).empty() || !session_in_picture(path)) return {};
    if (!opened.pictured.empty() && std::filesystem::exists(opened.pictured, ignored)) return opened.pictured;
    const bool has_file = !opened.session.procedural && !opened.session.raw_layout;
    return has_file ? opened.session.volume_path : std::filesystem::path();
}

/// Who opens a scan once more wants what was saved beside it: its session, if that is of this very file. Empty: there
/// is none.
std::filesystem::path session_saved_for(const std::filesystem::path& volume)
{
    std::error_code ignored;
    if (!session_file_of(volume).empty()) return {};
    const std::filesystem::path beside = session_path_of(volume);
    const std::optional<std::string> text = text_of_session(beside);
    if (!text) return {};
    const Session session = read_session(session_document(*text, beside.string()), beside.parent_path());
    const bool is_of_it = !session.procedural && std::filesystem::equivalent(session.volume_path, volume, ignored);
    return is_of_it ? beside : std::filesystem::path();
}

}  // namespace

std::string short_name(const std::filesystem::path& path)
{
    return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

struct Workbench::Opening {
    std::filesystem::path path;
    std::string name{};
    std::vector<std::string> settings{};
    double begun_s = 0.0;
    Work::Opening how{.program = {}};
    bool saves_before = true;
    bool comes_back = false;                             ///< what was put away
    std::vector<std::filesystem::path> taken_into_it{};  ///< annotation that was dropped with it

    Jobs::Number number = 0;                       ///< of the job that reads, and of this afterwards
    std::shared_ptr<Document::Read> read{};        ///< null: it is being read
    std::shared_ptr<std::exception_ptr> thrown{};  ///< by the job
    uint64_t journal_bytes = 0;         ///< of what is open, when reading began, where it has the same journal
    std::optional<Session> pictured{};  ///< the look of a picture, where that is opened
    std::unique_ptr<Scene> scene{};     ///< being loaded
};

Jobs::Number Workbench::opening_number() const
{
    return opening_ ? opening_->number : 0;
}

std::string_view Workbench::opening_name() const
{
    return opening_ ? std::string_view(opening_->name) : std::string_view();
}

std::vector<Jobs::State> Workbench::job_states() const
{
    std::vector<Jobs::State> states = savers_.states();
    if (opening_ && (opening_->read || opening_->comes_back)) states.push_back(state_of(*opening_));
    if (document_ && reload_) states.push_back(state_of_reload());
    if (document_ && screenshots_.has_large())
        states.push_back({.number = DRAWING,
                          .what = "drawing " + short_name(screenshots_.large_path()),
                          .fraction = screenshots_.progress()});
    for (Jobs::State& state : jobs_.states()) states.push_back(std::move(state));
    // Read, and nobody has looked yet.
    if (opening_ && std::ranges::find(states, opening_->number, &Jobs::State::number) == states.end())
        states.push_back(state_of(*opening_));
    return states;
}

Jobs::State Workbench::state_of(const Opening& opening) const
{
    const std::string name = short_name(opening.path);
    return {.number = opening.number,
            .what = "opening " + name,
            .stretch = opening.scene ? "loading " + name + " onto the device" : std::string(),
            .detail = opening.scene ? std::string() : "waits until the work is saved",
            .fraction = opening.scene ? opening.scene->loaded() : -1.0,
            .seconds = options_.now_s() - opening.begun_s};
}

void Workbench::begin_open(const std::filesystem::path& path, const std::vector<std::string>& settings)
{
    start_opening({.path = path, .settings = settings});
}

void Workbench::begin_open_with(const std::filesystem::path& path, std::vector<std::filesystem::path> taken_into_it)
{
    start_opening({.path = path, .taken_into_it = std::move(taken_into_it)});
}

void Workbench::start_opening(Opening next)
{
    if (opening_) {
        jobs_.cancel(opening_->number);  // nobody waits for it any more
        opening_.reset();
        follow_jobs();
    }
    cancel_reload();
    open_failure_.clear();
    failed_path_.clear();
    next.name = short_name(next.path);
    next.begun_s = options_.now_s();
    if (next.how.program.empty()) next.how.program = "shvr view";
    opening_ = std::make_shared<Opening>(std::move(next));
    read_next();
}

void Workbench::open(const std::filesystem::path& path, const std::vector<std::string>& settings, Work::Opening how)
{
    const auto failure = std::make_shared<std::exception_ptr>();
    awaited_failure_ = failure;
    start_opening({.path = path, .settings = settings, .how = std::move(how), .saves_before = false});
    while (opening_) {
        follow_jobs();
        follow_opening();
        if (opening_ && !opening_->scene) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    awaited_failure_.reset();
    if (*failure) std::rethrow_exception(*failure);
}

/// Begins to read on the worker; once more where what is open has changed the journal since.
void Workbench::read_next()
{
    Opening& opening = *opening_;
    opening.read.reset();
    opening.thrown = std::make_shared<std::exception_ptr>();
    Work::Opening how = opening.how;
    std::function<void()> flush;
    if (document_) {
        Work& work = document_->annotator.work();
        if (!how.hold) how.hold = work.hold();
        flush = work.flusher();
        opening.journal_bytes = work.journal().bytes;
    }
    const std::filesystem::path path = opening.path;
    const auto read = [this, path, settings = opening.settings, how, flush, goes_on = !options_.is_script](
                          ProgressReporter& reporter) -> std::pair<Document::Read, std::optional<Session>> {
        const std::string name = short_name(path);
        if (flush) flush();
        const OpeningOptions options{.measure = {.progress = reporter.begin("measuring " + name)}};
        const std::filesystem::path saved =
            goes_on && settings.empty() ? session_saved_for(path) : std::filesystem::path();
        std::filesystem::path input = saved.empty() ? path : saved;
        std::optional<Session> pictured{};
        OpenedSession opened = open_session(input, settings, options);
        if (const std::filesystem::path of = opened_for_picture(input, opened); !of.empty()) {
            pictured = std::move(opened.session);
            input = of;
            opened = open_session(input, settings, options);
        }
        const Session& session = opened.session;
        opened.source = renderer_.with_levels(std::move(opened.source), session.render, shows_occlusion(session.light),
                                              reporter.begin("making coarser levels of " + name));
        Work::Opening with_progress = how;
        with_progress.progress = reporter.begin("reading the work on " + name);
        return {Document::read(std::move(opened), input, settings, std::move(with_progress)), std::move(pictured)};
    };
    opening.number = jobs_.start(
        "opening " + short_name(path),
        [this, read, thrown = opening.thrown](ProgressReporter& reporter) -> Jobs::Completion {
            try {
                auto result = read(reporter);
                auto done = std::make_shared<Document::Read>(std::move(result.first));
                static_cast<void>(reporter.begin({}));  // what nobody waits for any more lets go of its journal now
                return [this, thrown, done, pictured = std::move(result.second)] {
                    if (!opening_ || opening_->thrown != thrown) return;  // nobody waits for it any more
                    opening_->read = done;
                    opening_->pictured = pictured;
                };
            } catch (...) {
                *thrown = std::current_exception();
                throw;
            }
        });
}

void Workbench::follow_opening()
{
    if (!opening_) return;
    try {
        if (!opening_->scene && !opening_->comes_back) {
            if (!opening_->read || !is_ready_to_load()) return;
            begin_loading();
        }
        if (opening_->scene && opening_->scene->load_on(SLICE_S)) finish_opening();
    } catch (const DeviceLost&) {
        throw;  // it goes on once there is a device again
    } catch (...) {
        end_opening(std::current_exception());
    }
}

/// What is open is saved, and its journal is as it was read.
bool Workbench::is_ready_to_load()
{
    if (!document_) return true;
    if (opening_->saves_before) {
        std::string why;
        const Leave leave_now = leave(why);
        if (leave_now == Leave::later) return false;
        if (leave_now == Leave::refused) fail("what is open cannot be saved: ", why);
    }
    Work& work = document_->annotator.work();
    if (!is_one_journal(document_->session.journal_path, opening_->read->opened.session.journal_path)) return true;
    if (is_saving()) return false;
    work.settle();  // it was flushed a moment ago
    if (work.journal().bytes == opening_->journal_bytes) return true;
    read_next();
    return false;
}

void Workbench::begin_loading()
{
    Document::Read& read = *opening_->read;
    const Session& session = read.opened.session;
    const bool has_light = shows_occlusion(session.light);
    drop_large_screenshot("opening another scan");
    if (!renderer_.fits_beside(*read.opened.source, session.render, has_light)) {
        if (document_) {
            document_->screen.clear();
            away_ = std::move(document_);
            away_->touch.use(nullptr);  // one servo at a time on a device
        }
        renderer_.take_scene();
    }
    opening_->scene = renderer_.begin_loading(read.opened.source, read.opened.statistics, session.render, has_light,
                                              read.work->document());
}

void Workbench::finish_opening()
{
    const std::shared_ptr<Opening> opening = std::exchange(opening_, nullptr);
    look_again();
    if (document_) document_->screen.clear();
    std::unique_ptr<Scene> before = renderer_.show(std::move(opening->scene));
    if (opening->comes_back) {
        try {
            away_->show_again(renderer_);
        } catch (const Error& error) {
            const std::string path = away_->session_path.string();
            away_.reset();
            renderer_.take_scene();
            return say(sentence(path, " cannot be shown again: ", error.what(), "; it is saved"), Weight::error);
        }
        document_ = std::move(away_);
        return say(document_->session_path.string() + " is open again");
    }
    const std::vector<std::string> losses = opening->read->opened.losses;
    std::unique_ptr<Document> next;
    try {
        next = std::make_unique<Document>(renderer_, std::move(*opening->read), options_.view);
    } catch (...) {
        renderer_.show(std::move(before));
        opening_ = opening;  // which ends now
        throw;
    }
    document_ = std::move(next);
    before.reset();
    away_.reset();
    opened_s_ = opening->begun_s;
    Preferences preferences = preferences_;
    preferences.note_opened(opening->path);
    prefer(std::move(preferences));
    ++openings_;
    read_voxel_.reset();
    settings_to_record_ = was_set_in_this_turn_ = has_tried_view_ = is_leaving_ = false;
    discarded_steps_.reset();
    steps_at_empty_stroke_.reset();
    to_keep_since_s_.reset();
    session_before_hand_.reset();
    journal_failure_.clear();
    save_failure_.clear();
    welcome(opening->path, losses);
    if (opening->pictured) show_picture(*opening->pictured);
    for (const std::filesystem::path& taken : opening->taken_into_it) act(TakeFile{.path = taken});
}

void Workbench::take(Document::Read read)
{
    read.is_script = options_.is_script;
    document_ = std::make_unique<Document>(renderer_, std::move(read), options_.view);
    document_->choose_thresholds(document_->session);
    ++openings_;
}

/// Says what was opened, and what is not as it was left: that stays to be seen until it is dismissed.
void Workbench::welcome(const std::filesystem::path& path, const std::vector<std::string>& losses)
{
    recovered_ = losses;
    for (const Notice& notice : document_->messages) recovered_.push_back(notice.text);
    std::string status = "Opened " + path.string();
    const std::filesystem::path& session = document_->session_path;  // of a scan, saved beside it
    if (document_->has_session_file() && session != path && session.parent_path() == path.parent_path())
        status += ", and goes on with " + session.filename().string();
    if (document_->only_looks()) status += "; read only, for it is open for writing in " + document_->holder;
    for (const std::string& loss : losses) status += "; " + loss;
    for (const std::string& warning : document_->volume().warnings) status += "; " + warning;
    for (const Notice& notice : document_->messages) status += "; " + notice.text;
    const bool is_as_left = recovered_.empty() && !document_->only_looks();
    say(status, is_as_left ? Weight::done : Weight::warning);
}

/// The look and the view of a picture, as settings that undo takes back.
void Workbench::show_picture(const Session& pictured)
{
    Session wanted = pictured;
    wanted.probe = document_->session.probe;
    const std::string patch = patch_between(document_->session, wanted);
    if (!patch.empty()) apply(Set{patch});
    record_settings();
    look_from(camera_named(pictured, pictured.camera_name, document_->volume()));
    say("Shown as in the picture; undo takes its settings back");
}

void Workbench::act(const DismissNotices&)
{
    recovered_.clear();
}

// ---- Where it does not come to its end ------------------------------------------------------------------------------

std::exception_ptr Workbench::opening_failure(const std::string& words) const
{
    if (opening_ && opening_->thrown && *opening_->thrown) return *opening_->thrown;
    return std::make_exception_ptr(Error(words));
}

void Workbench::cancel_opening()
{
    if (!opening_) return;
    if (opening_->comes_back) return;  // there is nothing else to be shown
    jobs_.cancel(opening_->number);
    say("Cancelled: opening " + short_name(opening_->path), Weight::warning);
    const std::shared_ptr<Opening> ended = std::exchange(opening_, nullptr);
    ended->scene.reset();
    if (away_) bring_back();
}

void Workbench::end_opening(std::exception_ptr failure)
{
    const std::shared_ptr<Opening> ended = std::exchange(opening_, nullptr);
    ended->scene.reset();
    look_again();
    std::string why = "an error of an unknown kind";
    try {
        std::rethrow_exception(failure);
    } catch (const std::bad_alloc& error) {
        why = sentence(ended->path.string(), ": ", told_of(error), "; close other programs, and open it again");
    } catch (const std::exception& error) {
        why = error.what();
    } catch (...) {
    }
    if (ended->comes_back) {
        const std::string path = away_ ? away_->session_path.string() : std::string();
        away_.reset();
        return say(sentence(why, "; ", path, " cannot be shown again either; it is saved"), Weight::error);
    }
    if (!ended->taken_into_it.empty()) why += "; what was dropped with it is not taken either";
    if (document_) why += "; " + document_->session_path.string() + " stays open";
    open_failure_ = why;
    failed_path_ = ended->path;
    if (awaited_failure_)
        *awaited_failure_ = document_ ? std::make_exception_ptr(Error(why)) : failure;
    else
        say(why, Weight::error);
    if (away_) bring_back();
}

/// Loads what was put away once more.
void Workbench::bring_back()
{
    opening_ = std::make_shared<Opening>(Opening{.path = away_->session_path,
                                                 .name = short_name(away_->session_path),
                                                 .begun_s = options_.now_s(),
                                                 .comes_back = true});
    opening_->number = next_return_++;
    const Session& session = away_->session;
    try {
        renderer_.take_scene();
        opening_->scene = renderer_.begin_loading(away_->source, away_->statistics, session.render,
                                                  shows_occlusion(session.light), away_->annotator.document());
    } catch (const DeviceLost&) {
        throw;
    } catch (...) {
        end_opening(std::current_exception());
    }
}

// ---- Where the graphics device is lost ------------------------------------------------------------------------------

void Workbench::stop_loading()
{
    if (opening_) opening_->scene.reset();
}

/// What is read is loaded from its beginning.
void Workbench::load_once_more()
{
    if (away_ && (!opening_ || opening_->comes_back)) bring_back();
}

std::filesystem::path Workbench::screenshot_stem() const
{
    const std::filesystem::path stem = std::filesystem::path(document_->session_path).replace_extension();
    // The example lies among the settings, in a folder that is hidden, where nobody looks for pictures.
    const bool is_example = stem.parent_path() == options_.preferences.parent_path() / "example";
    const char* const home = std::getenv("HOME");
    return is_example && home && *home ? std::filesystem::path(home) / stem.filename() : stem;
}

}  // namespace shvr::ui
