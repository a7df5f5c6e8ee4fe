#include "engine/workbench/desk/look_shelf.h"

#include <algorithm>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/session/session_patch.h"

namespace shvr::ui {

std::filesystem::path LookShelf::folder() const
{
    if (options_.settings.empty())
        fail("no settings folder is known; expected HOME or XDG_CONFIG_HOME in the environment");
    return options_.settings / "looks";
}

void LookShelf::load()
{
    if (options_.settings.empty()) return;
    std::vector<std::string> warnings;
    looks_ = looks_in(folder(), warnings);
    for (std::string& warning : warnings) say(std::move(warning), Weight::warning);
}

void LookShelf::act(const KeepLook& action)
{
    const bool is_for_all = action.path.empty();
    const std::string kept(trimmed(action.name));  // "a" and "a " would read the same
    const std::filesystem::path file = is_for_all ? look_file(folder(), kept) : action.path;
    if (!is_for_all && is_there(file)) fail(file.string(), ": exists already; expected a name that is free");
    const std::string name = is_for_all ? kept : file.stem().string();
    const std::string text = text_of(look_of(document_->session, name, document_->statistics));
    std::error_code error;
    if (is_for_all) std::filesystem::create_directories(file.parent_path(), error);
    if (error) fail(file.parent_path().string(), ": cannot be made: ", error.message());
    write_file_atomically(file, std::as_bytes(std::span(text)));
    if (is_for_all) load();
    say(is_for_all ? "Groups, light and transfer function are saved as the look " + name
                   : "Groups, light and transfer function are saved in " + file.string());
}

void LookShelf::act(const TakeLook& action)
{
    const auto found = std::ranges::find(looks_, action.name, &NamedLook::name);
    if (found == looks_.end()) fail("no look is kept as ", action.name, "; expected one that the menu shows");
    Session after = with_look(document_->session, *found, document_->statistics);
    const std::string patch = patch_between(document_->session, after);
    if (patch.empty()) return say("The scan has the look " + action.name + " already");
    log_instead({Set{patch}, EndStep{}});  // a log can be replayed on a machine without this look
    others_.record_settings({});           // what was changed before is a step of its own
    others_.take_session(std::move(after));
    others_.record_settings("applied the look " + action.name);
    say("Applied the look " + action.name + "; undo takes it back");
}

void LookShelf::act(const ForgetLook& action)
{
    const std::filesystem::path file = look_file(folder(), action.name);
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) fail(file.string(), ": cannot be removed: ", error.message());
    load();
    say("The look " + action.name + " is no longer kept");
}

}  // namespace shvr::ui
