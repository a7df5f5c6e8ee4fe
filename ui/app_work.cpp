// What actions do to the work: undo and redo, saving, pictures of it, another scan.

#include <algorithm>

#include "engine/base/image_file.h"
#include "ui/app.h"

namespace shvr::ui {

void App::apply(const Undo&)
{
    const Command* command = document_->annotator.undo();
    if (!command) return say("Nothing is left to undo");
    show_changes(*command);
    say("Undone: " + command->label);
}

void App::apply(const Redo&)
{
    const Command* command = document_->annotator.redo();
    if (!command) return say("Nothing is left to redo");
    show_changes(*command);
    say("Redone: " + command->label);
}

/// What the window says of the trace; the scene itself learns of changes from the annotator.
void App::show_changes(const Command& command)
{
    Document& document = *document_;
    const bool is_traced = std::ranges::any_of(
        command.changes, [](const Change& change) { return std::holds_alternative<TraceChange>(change); });
    if (is_traced) document.drags_node = false;
}

void App::apply(const Save&)
{
    save();
}

std::filesystem::path App::free_screenshot_path() const
{
    const std::filesystem::path stem = std::filesystem::path(document_->session_path).replace_extension();
    for (int number = 1;; ++number) {
        std::filesystem::path path = sentence(stem.string(), "-view-", number, ".png");
        if (!std::filesystem::exists(path)) return path;
    }
}

void App::apply(const Screenshot& action)
{
    if (!action.is_large) {
        wants_screenshot_ = true;
        return say("The screenshot is taken as soon as the picture is sharp");
    }
    Session session = document_->saved_session();
    session.render.size = viewport_.pixels() * session.interaction.screenshot_scale;
    RenderOptions options;
    options.part_pixels = 96;  // what a hand that comes back waits for
    large_screenshot_ = std::make_unique<PictureJob>(*renderer_, session, document_->camera, options);
    say(sentence("A screenshot of ", session.render.size.x, " x ", session.render.size.y,
                 " pixels is made while nothing else is to be drawn"));
}

void App::apply(const SetInteraction& action)
{
    document_->session.interaction = action.interaction;
    document_->is_saved = false;
    look_again();
}

/// A part of it, whenever the screen has all it wants. Paint would be in some parts and not in others.
void App::advance_large_screenshot()
{
    if (document_->annotator.stroke_is_running()) {
        large_screenshot_.reset();
        return say("The large screenshot is given up: painting goes first");
    }
    if (something_moves() || !document_->screen.complete() || screenshot_.valid()) return;
    try {
        if (!large_screenshot_->is_done()) {
            large_screenshot_->step();
            status_ = sentence("Large screenshot: ", int(100.0 * large_screenshot_->progress()), " %");
            return;
        }
        write_screenshot(to_image8(large_screenshot_->take().image));
    } catch (const Error& error) {
        say(error.what());
    }
    large_screenshot_.reset();
}

/// Packing the file takes long, and goes to another thread.
void App::write_screenshot(Image8 image)
{
    screenshot_ = std::async(std::launch::async, [image = std::move(image), path = free_screenshot_path()] {
        try {
            write_png(path, image);
            return "Screenshot: " + path.string();
        } catch (const Error& error) {
            return std::string(error.what());
        }
    });
}

void App::finish_screenshot()
{
    if (!document_->screen.complete() || screenshot_.valid()) return;
    wants_screenshot_ = false;
    write_screenshot(document_->screen.read_back());
}

void App::apply(const Open& action)
{
    if (document_ && !document_->work_is_saved()) save();
    open(action.path, {});
}

void App::save()
{
    Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_open()) annotator.end_stroke();
    while (annotator.stroke_is_running()) annotator.advance();  // what is on its way belongs to it
    document_->save();
    const std::filesystem::path& trace = document_->session.trace_path;
    const bool has_trace = !trace.empty() && std::filesystem::exists(trace);
    say("Saved " + document_->session.mask_path.string() + (has_trace ? ", " + trace.string() : std::string()) +
        " and " + document_->session_path.string());
}

void App::apply(const ShowHelp& action)
{
    shows_help_ = action.on;
}

void App::apply(const Quit&)
{
    window_.close();
}

}  // namespace shvr::ui
