#include "engine/workbench/desk/desk.h"

#include <chrono>
#include <utility>

#include "engine/workbench/actions/action_rows.h"

namespace shvr::ui {

std::string short_name(const std::filesystem::path& path)
{
    return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

Desk::Desk(Renderer& with, WorkbenchOptions how) : renderer(with), options(std::move(how))
{
    if (!options.now_s)
        options.now_s = [] {
            return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
        };
}

void Desk::say(std::string text, Weight weight)
{
    messages.add(options.now_s(), weight, std::move(text));
    if (are_messages_shown) messages.note_read();
}

void Desk::log_instead(const Actions& actions)
{
    if (!log) return;
    for (const Action& action : actions) logged_instead.push_back(line_of(action));
}

DocumentModel Desk::document_model() const
{
    if (!document)
        return {.session = nothing.session,
                .volume = nothing.volume,
                .statistics = nothing.statistics,
                .camera = nothing.camera,
                .session_path = nothing.path,
                .messages = messages};
    return {.is_open = true,
            .session = document->session,
            .volume = document->volume(),
            .statistics = document->statistics,
            .camera = document->camera,
            .session_path = document->session_path,
            .has_session_file = document->has_session_file(),
            .holder = document->holder,
            .outside = document->outside,
            .remote = document->remote,
            .messages = messages};
}

}  // namespace shvr::ui
