#include "engine/workbench/workbench.h"

#include <new>
#include <utility>

#include "engine/base/text.h"
#include "engine/workbench/desk/declined.h"

namespace shvr::ui {

Workbench::Workbench(Renderer& renderer, WorkbenchOptions options) : desk_(renderer, std::move(options))
{
    desk_.apply = [this](const Action& action) { return apply(action); };
    desk_.model = [this] { return model(); };
    services_.presets.load();
    services_.looks.load();
    services_.keeper.load();
    services_.tasks.look_for_unfinished();
}

/// Finishes writing files, including the preferences.
Workbench::~Workbench()
{
    static_cast<void>(desk_.savers.wait());
}

// ---- Actions --------------------------------------------------------------------------------------------------------

void Workbench::perform(const Action& action)
{
    const std::unique_ptr<Document>& document = desk_.document;
    if (!document && !ui::why_not(model(), action).empty())
        fail(services_.opener.is_opening() ? sentence(services_.opener.opening_name(), " is being opened")
                                           : std::string("Nothing is open"));
    if (desk_.log && document && document->touch.servo()) {
        const bool slices_stay = document->session.view.slices.cross.has_value();
        desk_.log(line_of(PlaceProbe{.voxel = document->probe_voxel(), .hovers = slices_stay}));
    }
    if (document && document->annotator.stroke_is_running() && waits_for_strokes(model(), action))
        services_.painter.await_strokes();
    recent_.begin(action);
    desk_.logged_instead.clear();
    carry_out(action);
    if (desk_.options.is_script && document && document->annotator.is_behind()) document->annotator.catch_up();
    recent_.note_done();
    if (!desk_.log) return;
    if (desk_.logged_instead.empty()) desk_.logged_instead.push_back(line_of(action));
    for (const std::string& line : desk_.logged_instead) desk_.log(line);
}

/// Passes the action to the service named in the action's row.
void Workbench::carry_out(const Action& action)
{
    action.visit([&]<class Kind>(const Kind& each) {
        using Row = std::tuple_element_t<INDEX_OF_KIND<Kind>, ActionRows>;
        services_.of<typename Row::Service>().act(each);
    });
}

bool Workbench::apply(const Action& action)
{
    try {
        perform(action);
        return true;
    } catch (const DeviceLost&) {
        throw;
    } catch (const std::bad_alloc& error) {
        say(sentence(row_of(action).name, ": ", told_of(error)), Weight::error);
        return false;
    } catch (const std::exception& error) {
        // What was unavailable has not failed, but work that is not saved when a person asks for it needs attention.
        const bool is_unavailable = dynamic_cast<const Declined*>(&error) || !ui::why_not(model(), action).empty();
        const bool is_declined = is_unavailable && !action.as<SaveOp>();
        if (desk_.document && !is_unavailable) services_.painter.note_trouble(told_of(error));
        say(told_of(error), is_declined ? Weight::done : Weight::error);
        return false;
    }
}

void Workbench::set_pixels(const glm::uvec2& pixels)
{
    if (pixels != services_.viewer.pixels()) perform(Resize{pixels});
}

// ---- Steps ----------------------------------------------------------------------------------------------------------

void Workbench::advance()
{
    for (Service* const each : turn_)
        if (desk_.document || each->advances_without_document()) each->advance();
}

bool Workbench::has_work() const
{
    const Services& all = services_;
    if (!desk_.jobs.is_idle() || !desk_.savers.is_idle() || all.opener.is_opening() || all.reloader.is_wanted() ||
        is_saving())
        return true;
    const std::unique_ptr<Document>& document = desk_.document;
    return document &&
           (!document->screen.complete() || document->annotator.stroke_is_running() || document->touch.servo() ||
            document->annotator.is_behind() || is_stirring() || all.photographer.is_writing() ||
            all.photographer.has_large() || !document->previewer.is_current() || document->meter.is_asking());
}

bool Workbench::shows_jobs() const
{
    const Services& all = services_;
    return all.opener.is_opening() || is_saving() || all.saver.is_copying() || all.reloader.is_wanted() ||
           all.photographer.has_large() || !desk_.jobs.is_idle();
}

Model Workbench::model() const
{
    const Services& all = services_;
    return {desk_.document_model(),
            all.viewer.model(),
            all.reader.model(),
            all.prober.model(),
            all.hand.model(),
            all.painter.model(),
            all.groups.model(),
            all.tracer.model(),
            all.settings.model(),
            all.saver.model(),
            all.opener.model(),
            all.taker.model(),
            all.tasks.model(),
            all.keeper.model(),
            all.presets.model(),
            all.window.model(),
            {.recent = &recent_, .version = desk_.options.version},
            all.looks.model(),
            all.meshes.model()};
}

}  // namespace shvr::ui
