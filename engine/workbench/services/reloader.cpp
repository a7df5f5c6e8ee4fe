#include "engine/workbench/services/reloader.h"

#include "engine/workbench/services/opener.h"

namespace shvr::ui {

namespace {

constexpr Jobs::Number NUMBER_OF_RELOAD = Jobs::Number{1} << 49;  // no job has it

}  // namespace

struct Reloader::Reload {
    RenderSettings before;                         ///< settings with which the displayed scene was loaded
    Jobs::Number number = 0;                       ///< number of the reading job; 0: it has not been started
    std::shared_ptr<const VolumeSource> source{};  ///< null: still being read
    std::unique_ptr<Scene> scene{};                ///< null: loading has not begun
    bool is_shown = false;                         ///< the earlier scene is gone
};

Reloader::Reloader(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

Reloader::~Reloader() = default;

/// Requests a reload with the session's settings. Fails if the volume is too large for them.
void Reloader::want(const RenderSettings& before)
{
    if (others_.is_opening()) fail(others_.opening_name(), " is being opened; expected that to have ended");
    if (others_.is_drawing_picture())
        fail("a picture or movie is being drawn; wait for it, or cancel it, before the volume is loaded otherwise");
    const Session& session = document_->session;
    renderer_.check_sizes(*document_->source, session.render, shows_occlusion(session.light));
    if (reload_) jobs_.cancel(reload_->number);  // its result is no longer wanted
    reload_ = std::make_shared<Reload>(Reload{.before = reload_ ? reload_->before : before});
}

std::string Reloader::title() const
{
    return "loading " + short_name(document_->session_path) + " once more";
}

/// If bricks will be paged and the volume has no coarser levels, makes them on the worker, since that reads all voxels.
void Reloader::read()
{
    const Session& session = document_->session;
    if (!renderer_.estimate(*document_->source, session.render, shows_occlusion(session.light)).makes_levels) {
        reload_->source = document_->source;  // at once, whatever the worker is doing
        return;
    }
    const auto levels = [&renderer = renderer_, source = document_->source, settings = session.render,
                         has_light = shows_occlusion(session.light),
                         reserved = Scene::bytes_to_show(document_->annotator.document()),
                         name = short_name(document_->session_path)](ProgressReporter& reporter) {
        return renderer.with_levels(source, settings, has_light, reserved,
                                    reporter.begin("making coarser levels of " + name));
    };
    const std::weak_ptr<Reload> of = reload_;
    reload_->number = jobs_.start(title(), [levels, of](ProgressReporter& reporter) -> Jobs::Completion {
        return [of, source = levels(reporter)] {
            if (const std::shared_ptr<Reload> reload = of.lock()) reload->source = source;
        };
    });
}

void Reloader::begin()
{
    const Session& session = document_->session;
    const bool has_light = shows_occlusion(session.light);
    const shvr::Document& work = document_->annotator.document();
    others_.drop_screenshot("reloading the volume");
    if (!renderer_.fits_beside(*reload_->source, session.render, has_light, work)) return load_alone();
    reload_->scene = renderer_.begin_loading(reload_->source, document_->statistics, session.render, has_light, work);
}

void Reloader::load_alone()
{
    if (!reload_->is_shown) document_->scene_source = reload_->source;
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
    document_->scene_source = reload_->source;
    say("Reloaded: " + document_->shown_name());
}

void Reloader::advance()
{
    if (!reload_ || !document_) return;
    try {
        if (!reload_->source && reload_->number == 0) read();
        if (!reload_->source) return;
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
        return give_up(error.what());
    }
    reload_.reset();
    others_.look_again();
}

void Reloader::restore_settings()
{
    document_->session.render.sampling = reload_->before.sampling;
    document_->session.render.paging = reload_->before.paging;
    others_.note_edit();
}

void Reloader::give_up(const std::string& why)
{
    restore_settings();
    say(sentence(why, "; the volume stays as it was loaded"), Weight::error);
    if (reload_->is_shown) load_alone();
    reload_.reset();
    others_.look_again();
}

bool Reloader::end_reading(const Jobs::Finished& job)
{
    if (!reload_ || reload_->number != job.number) return false;
    if (job.was_cancelled) {
        say("Cancelled: " + title());
        cancel();
    } else if (!job.failure.empty()) {
        give_up(job.failure);
    }
    return true;
}

bool Reloader::cancel()
{
    if (!reload_) return false;
    restore_settings();
    jobs_.cancel(reload_->number);
    reload_.reset();
    return true;
}

bool Reloader::cancel(Jobs::Number number)
{
    if (number != NUMBER_OF_RELOAD || !cancel()) return false;
    say("Cancelled: " + title());
    return true;
}

void Reloader::add_loading(std::vector<Jobs::State>& states) const
{
    if (!reload_ || !document_ || (reload_->number != 0 && !reload_->source)) return;
    states.push_back(
        {.number = NUMBER_OF_RELOAD, .what = title(), .fraction = reload_->scene ? reload_->scene->loaded() : -1.0});
}

/// Drops pending requests to the scene, which is about to be replaced.
void Reloader::drop_queries()
{
    document_->previewer.drop();
    document_->meter.drop();
    document_->touch.drop_queries();
}

}  // namespace shvr::ui
