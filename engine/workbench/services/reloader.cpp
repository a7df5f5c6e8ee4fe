#include "engine/workbench/services/reloader.h"

#include "engine/workbench/services/services.h"

namespace shvr::ui {

struct Reloader::Reload {
    RenderSettings before;           ///< settings with which the displayed scene was loaded
    std::unique_ptr<Scene> scene{};  ///< null: it has not begun
};

Reloader::Reloader(Services& all)
    : Service(all.desk),
      opener_(all.opener),
      photographer_(all.photographer),
      settings_(all.settings),
      viewer_(all.viewer)
{}

Reloader::~Reloader() = default;

/// Reports at once if the volume cannot be loaded with the session's settings.
void Reloader::want(const RenderSettings& before)
{
    if (opener_.is_opening()) fail(opener_.opening_name(), " is being opened; expected that to have ended");
    const Session& session = document_->session;
    renderer_.check_sizes(*document_->source, session.render, shows_occlusion(session.light));
    reload_ = std::make_shared<Reload>(Reload{.before = reload_ ? reload_->before : before});
}

void Reloader::begin()
{
    const Session& session = document_->session;
    const bool has_light = shows_occlusion(session.light);
    photographer_.drop_large("reloading the volume");
    if (!renderer_.fits_beside(*document_->source, session.render, has_light)) {
        reload_.reset();
        drop_queries();
        document_->screen.clear();
        opener_.put_away();
        return opener_.bring_back();
    }
    reload_->scene = renderer_.begin_loading(document_->source, document_->statistics, session.render, has_light,
                                             document_->annotator.document());
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
        drop_queries();
        document_->screen.clear();
        const std::unique_ptr<Scene> before = renderer_.show(std::move(reload_->scene));
        document_->show_again(renderer_);
        say("Reloaded: " + document_->session_path.string());
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        Session& session = document_->session;
        session.render.sampling = reload_->before.sampling;
        session.render.paging = reload_->before.paging;
        settings_.note_edit();
        say(sentence(error.what(), "; the volume stays as it was loaded"), Weight::error);
    }
    reload_.reset();
    viewer_.look_again();
}

bool Reloader::cancel()
{
    if (!reload_) return false;
    document_->session.render.sampling = reload_->before.sampling;
    document_->session.render.paging = reload_->before.paging;
    settings_.note_edit();
    reload_.reset();
    return true;
}

Jobs::State Reloader::state() const
{
    const std::string name = short_name(document_->session_path);
    return {.number = NUMBER,
            .what = "loading " + name + " once more",
            .fraction = reload_->scene ? reload_->scene->loaded() : -1.0};
}

/// Drops pending requests to the scene that is replaced.
void Reloader::drop_queries()
{
    document_->previewer.drop();
    document_->meter.drop();
    document_->touch.drop_queries();
}

}  // namespace shvr::ui
