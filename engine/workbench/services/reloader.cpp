#include "engine/workbench/services/reloader.h"

#include "engine/workbench/services/opener.h"

namespace shvr::ui {

namespace {

constexpr Jobs::Number NUMBER_OF_RELOAD = Jobs::Number{1} << 49;  // no job has it

}  // namespace

struct Reloader::Reload {
    RenderSettings before;           ///< settings with which the displayed scene was loaded
    std::unique_ptr<Scene> scene{};  ///< null: it has not begun
    bool is_shown = false;           ///< the earlier scene is gone
};

Reloader::Reloader(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

Reloader::~Reloader() = default;

/// Requests a reload with the session's settings. Fails if the volume is too large for them.
void Reloader::want(const RenderSettings& before)
{
    if (others_.is_opening()) fail(others_.opening_name(), " is being opened; expected that to have ended");
    const Session& session = document_->session;
    renderer_.check_sizes(*document_->source, session.render, shows_occlusion(session.light));
    reload_ = std::make_shared<Reload>(Reload{.before = reload_ ? reload_->before : before});
}

void Reloader::begin()
{
    const Session& session = document_->session;
    const bool has_light = shows_occlusion(session.light);
    const shvr::Document& work = document_->annotator.document();
    others_.drop_screenshot("reloading the volume");
    if (!renderer_.fits_beside(*document_->source, session.render, has_light, work)) return load_alone();
    reload_->scene = renderer_.begin_loading(document_->source, document_->statistics, session.render, has_light, work);
}

void Reloader::load_alone()
{
    reload_.reset();
    drop_queries();
    document_->screen.clear();
    others_.load_alone();
}

/// Replaces the scene. Fails if paint that was added meanwhile does not fit beside it.
void Reloader::show()
{
    drop_queries();
    document_->screen.clear();
    renderer_.show(std::move(reload_->scene)).reset();  // the work needs its room
    reload_->is_shown = true;
    document_->show_again(renderer_);
    say("Reloaded: " + document_->shown_name());
}

void Reloader::advance()
{
    if (!reload_ || !document_) return;
    try {
        if (!reload_->scene) {
            if (document_->annotator.stroke_is_running()) return;
            begin();
            if (!reload_) return;
        }
        if (!reload_->scene->load_on(Opener::SLICE_S) || document_->annotator.stroke_is_running()) return;
        show();
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        Session& session = document_->session;
        session.render.sampling = reload_->before.sampling;
        session.render.paging = reload_->before.paging;
        others_.note_edit();
        say(sentence(error.what(), "; the volume stays as it was loaded"), Weight::error);
        if (reload_->is_shown) load_alone();
    }
    reload_.reset();
    others_.look_again();
}

bool Reloader::cancel()
{
    if (!reload_) return false;
    document_->session.render.sampling = reload_->before.sampling;
    document_->session.render.paging = reload_->before.paging;
    others_.note_edit();
    reload_.reset();
    return true;
}

bool Reloader::cancel(Jobs::Number number)
{
    if (number != NUMBER_OF_RELOAD || !cancel()) return false;
    say("Cancelled: reloading");
    return true;
}

void Reloader::add_loading(std::vector<Jobs::State>& states) const
{
    if (!reload_ || !document_) return;
    states.push_back({.number = NUMBER_OF_RELOAD,
                      .what = "loading " + short_name(document_->session_path) + " once more",
                      .fraction = reload_->scene ? reload_->scene->loaded() : -1.0});
}

/// Drops pending requests to the scene, which is about to be replaced.
void Reloader::drop_queries()
{
    document_->previewer.drop();
    document_->meter.drop();
    document_->touch.drop_queries();
}

}  // namespace shvr::ui
