#include "tools/golden/studio.h"

#include <cstdlib>

#include "engine/live/previewer.h"

namespace shvr::golden {

namespace {

/// Whether `set_environment` chose the device, and not the user.
bool is_default_device = false;

/// Creates the renderer. If the user has named no device, an error states that lavapipe is needed.
Renderer make_renderer(const StudioOptions& options)
{
    try {
        return Renderer({.device = {.device = options.device, .validation = options.validation},
                         .budget = {options.budget_device, 0}});
    } catch (const Error& error) {
        if (!is_default_device) throw;
        fail(error.what(),
             "; goldens are drawn on lavapipe (llvmpipe), of the package mesa-vulkan-drivers, unless "
             "--device names another device");
    }
}

}  // namespace

void set_environment(const std::string& device)
{
    ::setenv("GALLIVM_PERF", "no_aos_sampling", 0);
    is_default_device = device.empty() && std::getenv("SHVR_DEVICE") == nullptr;
    if (is_default_device) ::setenv("SHVR_DEVICE", std::string(LAVAPIPE).c_str(), 0);
}

Studio::Studio(const Golden& golden, const StudioOptions& options)
    : golden_(golden), opened_(golden.open()), renderer_(make_renderer(options))
{
    set_up();
}

Camera Studio::camera() const
{
    return camera_named(session(), session().camera_name, opened_.source->info());
}

bool Studio::is_lavapipe()
{
    return renderer_.device().traits().name.find(LAVAPIPE) != std::string::npos;
}

void Studio::set_up()
{
    renderer_.load(opened_.source, opened_.statistics, session().render, shows_occlusion(session().light));
    annotator_.emplace(renderer_);
    const bool has_files = !session().mask_path.empty() || !session().trace_path.empty();
    if (has_files) annotator_->open(work_files(session(), opened_.source->info()), {.only_look = true});
    renderer_.scene().show_surfaces(session().surfaces, annotator_->document().trace, session().groups);
    for (const ScriptLine& line : golden_.script) {
        const std::string place = sentence(golden_.file().string(), ": script line ", line.number);
        if (const auto* paint = std::get_if<PaintOp>(&line.op)) {
            if (annotator_->paint(in_session(*paint, session())) == 0) fail(place, " paints nothing");
        } else if (const auto* undo = std::get_if<UndoOp>(&line.op)) {
            for (int i = 0; i < undo->count; ++i)
                if (!annotator_->undo()) fail(place, ": nothing to undo");
        }
    }
}

Picture Studio::picture_of(const Session& session, const Camera& camera, bool counted)
{
    Picture picture = renderer_.render(
        session, camera, {.probe = shown_probe(session, renderer_, annotator_.value()), .count_work = counted});
    if (!picture.complete)
        fail(golden_.file().string(), ": the picture is incomplete",
             picture.warnings.empty() ? std::string() : ": " + picture.warnings.front());
    if (const size_t count = count_not_finite(picture.image))
        fail(golden_.file().string(), ": ", count, " values of the picture are no numbers");
    return picture;
}

Image8 Studio::draw(const Session& session, const Camera& camera)
{
    return to_image8(picture_of(session, camera, false).image);
}

Image8 Studio::draw()
{
    return draw(session(), camera());
}

Picture Studio::draw_counted()
{
    return picture_of(session(), camera(), true);
}

}  // namespace shvr::golden
