// Settings that load the volume once more (render.sampling, render.paging): in slices beside the scene that is shown,
// which stays in use until the next stands. Where the device has no room for both, the document is put away for the
// time, as for opening.

#include "ui/workbench/workbench.h"

namespace shvr::ui {

struct Workbench::Reload {
    RenderSettings before;           ///< as the scene that is shown was loaded
    std::unique_ptr<Scene> scene{};  ///< null: it has not begun
};

/// Where the volume cannot be loaded with the session's settings, that is said at once.
void Workbench::want_reload(const RenderSettings& before)
{
    if (opening_) fail(opening_name(), " is being opened; expected that to have ended");
    const Session& session = document_->session;
    renderer_.check_sizes(*document_->source, session.render, shows_occlusion(session.light));
    reload_ = std::make_shared<Reload>(Reload{.before = reload_ ? reload_->before : before});
}

void Workbench::begin_reload()
{
    const Session& session = document_->session;
    const bool has_light = shows_occlusion(session.light);
    drop_large_screenshot("loading the volume anew");
    if (!renderer_.fits_beside(*document_->source, session.render, has_light)) {
        reload_.reset();
        drop_queries();
        document_->screen.clear();
        away_ = std::move(document_);
        away_->touch.use(nullptr);  // one servo at a time on a device
        return bring_back();
    }
    reload_->scene = renderer_.begin_loading(document_->source, document_->statistics, session.render, has_light,
                                             document_->annotator.document());
}

void Workbench::follow_reload()
{
    if (!reload_ || !document_) return;
    try {
        if (!reload_->scene) {
            if (document_->annotator.stroke_is_running()) return;
            begin_reload();
            if (!reload_) return;
        }
        if (!reload_->scene->load_on(SLICE_S) || document_->annotator.stroke_is_running()) return;
        drop_queries();
        document_->screen.clear();
        const std::unique_ptr<Scene> before = renderer_.show(std::move(reload_->scene));
        document_->show_again(renderer_);
        say("Loaded once more: " + document_->session_path.string());
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        Session& session = document_->session;
        session.render.sampling = reload_->before.sampling;
        session.render.paging = reload_->before.paging;
        note_edit();
        say(sentence(error.what(), "; the volume stays as it was loaded"), Weight::error);
    }
    reload_.reset();
    look_again();
}

bool Workbench::cancel_reload()
{
    if (!reload_) return false;
    document_->session.render.sampling = reload_->before.sampling;
    document_->session.render.paging = reload_->before.paging;
    note_edit();
    reload_.reset();
    return true;
}

Jobs::State Workbench::state_of_reload() const
{
    const std::string name = short_name(document_->session_path);
    return {.number = RELOADING,
            .what = "loading " + name + " once more",
            .fraction = reload_->scene ? reload_->scene->loaded() : -1.0};
}

/// What was asked of the scene that goes.
void Workbench::drop_queries()
{
    document_->previewer.drop();
    document_->meter.drop();
    document_->touch.drop_queries();
}

}  // namespace shvr::ui
