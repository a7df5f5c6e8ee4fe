#include "engine/workbench/services/opener.h"

#include <chrono>
#include <limits>
#include <thread>

#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/session/first_look.h"
#include "engine/session/looks/new_scan.h"
#include "engine/session/picture_session.h"
#include "engine/session/session_keys.h"
#include "engine/session/session_patch.h"
#include "engine/tasks/file_content.h"
#include "engine/workbench/services/opening.h"
#include "engine/workbench/services/saver.h"

namespace shvr::ui {

namespace {

bool is_one_journal(const std::filesystem::path& a, const std::filesystem::path& b)
{
    return std::filesystem::absolute(a).lexically_normal() == std::filesystem::absolute(b).lexically_normal();
}

/// Returns the path to open for a picture: its project or its bare volume. Empty if the file is no picture, or if the
/// picture shows a raw file without a project, whose layout is stated only in the picture's session.
std::filesystem::path opened_for_picture(const std::filesystem::path& path, const OpenedSession& opened)
{
    std::error_code ignored;
    if (!session_file_of(path).empty() || !session_in_picture(path)) return {};
    if (!opened.pictured.empty() && std::filesystem::exists(opened.pictured, ignored)) return opened.pictured;
    const bool has_file = !opened.session.procedural && !opened.session.raw_layout;
    return has_file ? opened.session.volume_path : std::filesystem::path();
}

/// Returns whether a scan is opened for which no settings were ever saved: a file, or a project without a session.
bool is_new(const std::filesystem::path& input)
{
    std::error_code ignored;
    const std::filesystem::path session = session_file_of(input);
    return (session.empty() && !session_in_picture(input)) ||
           (!session.empty() && !std::filesystem::exists(session, ignored));
}

/// Returns the session saved next to a volume, so that opening the scan continues that session. Empty if no session is
/// there, or if it belongs to another file.
std::filesystem::path session_saved_for(const std::filesystem::path& volume)
{
    std::error_code ignored;
    if (leads_to_network(volume) || !session_file_of(volume).empty()) return {};
    const std::filesystem::path beside = session_path_of(volume);
    const std::optional<std::string> text = text_of_session(beside);
    if (!text) return {};
    const Session session = read_session(session_document(*text, beside.string()), beside.parent_path());
    const bool is_of_it = !session.procedural && std::filesystem::equivalent(session.volume_path, volume, ignored);
    return is_of_it ? beside : std::filesystem::path();
}

std::string lines_with(const std::vector<std::filesystem::path>& paths)
{
    std::string lines;
    for (const std::filesystem::path& path : paths) lines += path.string() + '\n';
    return lines;
}

}  // namespace

Opener::Opener(Desk& desk, PreferenceKeeper& keeper, Others others)
    : Service(desk), keeper_(keeper), others_(std::move(others))
{}

Opener::~Opener() = default;

void Opener::begin_open(const std::filesystem::path& path, const std::vector<std::string>& settings,
                        std::vector<std::filesystem::path> taken_into_it, bool asks)
{
    start({.path = path, .settings = settings, .asks = asks, .taken_into_it = std::move(taken_into_it)});
}

void Opener::start(Opening next)
{
    if (opening_) {
        jobs_.cancel(opening_->number);  // its result is no longer wanted
        opening_.reset();
        others_.advance_jobs();
    }
    others_.cancel_reload();
    open_failure_.clear();
    failed_path_.clear();
    next.path = take_query(next.path.string());
    next.name = short_name(next.path);
    next.begun_s = options_.now_s();
    if (next.how.program.empty()) next.how.program = "shvr view";
    opening_ = std::make_shared<Opening>(std::move(next));
    read_next();
}

void Opener::open(const std::filesystem::path& path, const std::vector<std::string>& settings, Work::Opening how)
{
    const auto failure = std::make_shared<std::exception_ptr>();
    awaited_failure_ = failure;
    start({.path = path, .settings = settings, .how = std::move(how), .saves_before = false});
    while (opening_) {
        others_.advance_jobs();
        advance();
        if (opening_ && !opening_->scene) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    awaited_failure_.reset();
    if (*failure) std::rethrow_exception(*failure);
}

struct Opener::ReadResult {
    Document::Read read;
    std::optional<Session> pictured{};
    std::string looks_like_labels{};
};

/// Starts reading on the worker. Called again if the open document's journal, which was read too, has changed since.
void Opener::read_next()
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
    const bool may_write_outside = options_.saves_outside || allowed_outside_.contains(path);
    const auto read = [path, settings = opening.settings, how, flush, may_write_outside, goes_on = !options_.is_script,
                       &renderer = renderer_](ProgressReporter& reporter) -> ReadResult {
        const std::string name = short_name(path);
        if (flush) flush();
        const OpeningOptions options{.measure = {.progress = reporter.begin("measuring " + name)}};
        const std::filesystem::path saved = goes_on ? session_saved_for(path) : std::filesystem::path();
        std::filesystem::path input = saved.empty() ? path : saved;
        std::optional<Session> pictured{};
        OpenedSession opened = open_session_for_first_look(input, settings, options);
        if (const std::filesystem::path of = opened_for_picture(input, opened); !of.empty()) {
            pictured = std::move(opened.session);
            input = of;
            opened = open_session_for_first_look(input, settings, options);
        }
        if (goes_on && !pictured && is_new(input)) {
            const bool is_cpu = renderer.device().traits().is_cpu;
            light_new_scan(opened.session, opened.source->info().size,
                           is_cpu ? MAX_OCCLUDED_BY_CPU : std::numeric_limits<int64_t>::max(), settings);
        }
        const bool is_far = leads_to_network(opened.session.volume_path);  // label images there are asked for no voxels
        std::string labels = goes_on && !is_far ? why_labels(input, *opened.source, opened.statistics) : std::string();
        Work::Opening with_progress = how;
        with_progress.progress = reporter.begin("reading the work on " + name);
        Document::Read document =
            Document::read(std::move(opened), input, settings, std::move(with_progress), may_write_outside);
        const Session& session = document.opened.session;
        document.opened.source = renderer.with_levels(
            std::move(document.opened.source), session.render, shows_occlusion(session.light),
            Scene::bytes_to_show(document.work->document()), reporter.begin("making coarser levels of " + name));
        return {std::move(document), std::move(pictured), std::move(labels)};
    };
    opening.number =
        jobs_.start("opening " + short_name(path),
                    [this, read, thrown = opening.thrown](ProgressReporter& reporter) -> Jobs::Completion {
                        try {
                            ReadResult result = read(reporter);
                            auto done = std::make_shared<Document::Read>(std::move(result.read));
                            static_cast<void>(reporter.begin({}));  // a cancelled job releases its journal here
                            return [this, thrown, done, pictured = std::move(result.pictured),
                                    labels = std::move(result.looks_like_labels)] {
                                if (!opening_ || opening_->thrown != thrown) return;  // its result is no longer wanted
                                opening_->read = done;
                                opening_->pictured = pictured;
                                opening_->looks_like_labels = labels;
                            };
                        } catch (...) {
                            *thrown = std::current_exception();
                            throw;
                        }
                    });
}

void Opener::advance()
{
    if (!opening_) return;
    try {
        if (!opening_->scene && !opening_->comes_back) {
            if (!opening_->read || asks_what_it_is() || !is_ready_to_load()) return;
            begin_loading();
        }
        if (opening_->scene && opening_->scene->load_on(SLICE_S)) finish();
    } catch (const DeviceLost&) {
        throw;  // keeps the opening: it continues once a device is available
    } catch (...) {
        end(std::current_exception());
    }
}

/// If the file looks like annotation of the open document, ends the opening, asks the user, and returns true.
bool Opener::asks_what_it_is()
{
    if (!document_ || !opening_->asks || opening_->looks_like_labels.empty()) return false;
    if (document_->session.volume_path == opening_->read->opened.session.volume_path) return false;  // it is open
    const std::shared_ptr<Opening> ended = std::exchange(opening_, nullptr);
    others_.ask_what_it_is({.path = ended->path,
                            .beside = lines_with(ended->taken_into_it),
                            .why = "looks like a label image: " + ended->looks_like_labels,
                            .may_be_offsets = false});
    return true;
}

/// Returns whether the open document is saved and, if the job read its journal, whether the journal is still unchanged.
bool Opener::is_ready_to_load()
{
    if (!document_) return true;
    if (opening_->saves_before) {
        std::string why;
        const Leave leave_now = others_.leave(why);
        if (leave_now == Leave::later) return false;
        if (leave_now == Leave::refused) fail("the open work cannot be saved: ", why);
    }
    Work& work = document_->annotator.work();
    if (!document_->remote.empty() || !opening_->read->remote.empty()) return true;  // one of them has no journal
    if (!is_one_journal(document_->session.journal_path, opening_->read->opened.session.journal_path)) return true;
    if (others_.is_saving()) return false;
    work.settle();  // it was flushed a moment ago
    if (work.journal().bytes == opening_->journal_bytes) return true;
    read_next();
    return false;
}

void Opener::begin_loading()
{
    Document::Read& read = *opening_->read;
    const Session& session = read.opened.session;
    const bool has_light = shows_occlusion(session.light);
    others_.drop_screenshot("opening another scan");
    if (!renderer_.fits_beside(*read.opened.source, session.render, has_light, read.work->document())) {
        if (document_) {
            document_->screen.clear();
            put_away();
        }
        renderer_.take_scene();
    }
    opening_->scene = renderer_.begin_loading(read.opened.source, read.opened.statistics, session.render, has_light,
                                              read.work->document());
}

void Opener::finish()
{
    const std::shared_ptr<Opening> opening = std::exchange(opening_, nullptr);
    others_.look_again();
    if (document_) document_->screen.clear();
    std::unique_ptr<Scene> before = renderer_.show(std::move(opening->scene));
    if (opening->comes_back) return show_again();
    const std::vector<std::string> losses = opening->read->opened.losses, removed = opening->read->opened.removed;
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
    begin_document(*opening);
    looks_like_labels_ = document_->has_session_file() ? std::string() : opening->looks_like_labels;
    welcome(opening->path, losses, removed);
    if (opening->pictured) show_picture(*opening->pictured);
    for (const std::filesystem::path& taken : opening->taken_into_it)
        others_.load_annotation(LoadAnnotation{.path = taken});
}

/// Shows the previous document again, after it was unloaded to make room for another one.
void Opener::show_again()
{
    try {
        away_->show_again(renderer_);
    } catch (const Error& error) {
        const std::string path = away_->shown_name();
        away_.reset();
        renderer_.take_scene();
        return say(sentence(path, " cannot be shown again: ", error.what(), "; it is saved"), Weight::error);
    }
    document_ = std::move(away_);
    say(document_->shown_name() + " is shown again");
}

/// Resets all state of services that belongs to the previous document.
void Opener::begin_document(const Opening& opening)
{
    desk_.opened_s = opening.begun_s;
    keeper_.note_opened(opening.path);
    ++desk_.openings;
    others_.begin_document();
}

void Opener::take(Document::Read read)
{
    read.is_script = options_.is_script;
    document_ = std::make_unique<Document>(renderer_, std::move(read), options_.view);
    document_->choose_thresholds(document_->session);
    ++desk_.openings;
}

/// Reports what was opened, and how it differs from the last save; the differences stay on display until dismissed.
void Opener::welcome(const std::filesystem::path& path, const std::vector<std::string>& losses,
                     const std::vector<std::string>& removed)
{
    recovered_ = losses;
    for (const Notice& notice : document_->messages) recovered_.push_back(notice.text);
    std::string status = "Opened " + path.string();
    const std::filesystem::path& session = document_->session_path;  // a scan's session, saved next to it
    if (document_->has_session_file() && session != path && session.parent_path() == path.parent_path())
        status += ", and goes on with " + session.filename().string();
    if (document_->only_looks()) status += "; read only, for " + document_->why_only_looks();
    for (const std::string& loss : losses) status += "; " + loss;
    for (const std::string& setting : removed) status += "; " + setting;
    for (const std::string& warning : document_->volume().warnings) status += "; " + warning;
    for (const Notice& notice : document_->messages) status += "; " + notice.text;
    if (!looks_like_labels_.empty()) status += "; it looks like a label image: " + looks_like_labels_;
    const bool is_as_left =
        recovered_.empty() && removed.empty() && looks_like_labels_.empty() && !document_->only_looks();
    say(status, is_as_left ? Weight::done : Weight::warning);
}

/// Applies the look of a picture as settings, which can be undone, and the picture's view.
void Opener::show_picture(const Session& pictured)
{
    Session wanted = pictured;
    wanted.probe = document_->session.probe;
    const std::string patch = patch_between(document_->session, wanted);
    if (!patch.empty()) apply(Set{patch});
    others_.record_settings();
    others_.look_from(camera_named(pictured, pictured.camera_name, document_->volume()));
    say("Shown as in the picture; undo restores the previous settings");
}

void Opener::act(const DismissNotices&)
{
    recovered_.clear();
    looks_like_labels_.clear();
}

}  // namespace shvr::ui
