#include "engine/workbench/desk/preset_shelf.h"

#include <algorithm>

#include "engine/base/atomic_file.h"
#include "engine/base/text.h"

namespace shvr::ui {

std::filesystem::path PresetShelf::folder() const
{
    if (options_.settings.empty())
        fail("no settings folder is known; expected HOME or XDG_CONFIG_HOME in the environment");
    return options_.settings / "transfer_functions";
}

/// Loads the presets that ship with the program, then the user's own.
void PresetShelf::load()
{
    presets_.clear();
    try {
        presets_ = transfer_presets();
    } catch (const Error& error) {
        say(error.what(), Weight::warning);
    }
    if (options_.settings.empty()) return;
    std::vector<std::string> warnings;
    for (TransferPreset& preset : own_transfer_presets(folder(), warnings)) presets_.push_back(std::move(preset));
    for (std::string& warning : warnings) say(std::move(warning), Weight::warning);
}

const TransferPreset& PresetShelf::own(const std::string& name) const
{
    const auto found = std::ranges::find_if(
        presets_, [&](const TransferPreset& preset) { return preset.is_own && preset.name == name; });
    if (found == presets_.end()) fail("no transfer function is named '", name, "'; expected one that the list shows");
    return *found;
}

/// Returns the file for a preset of this name. Fails if a shipped preset has the name, since the list would show both.
std::filesystem::path PresetShelf::free_file(const std::string& name) const
{
    const std::filesystem::path file = preset_file(folder(), name);
    if (std::ranges::any_of(presets_, [&](const TransferPreset& each) { return !each.is_own && each.name == name; }))
        fail("'", name, "' is a supplied transfer function; expected another name");
    return file;
}

void PresetShelf::act(const KeepPreset& action)
{
    const std::string name(trimmed(action.name));  // "a" and "a " would read the same
    const std::filesystem::path file = free_file(name);
    const TransferPreset preset = preset_of(document_->session.transfer_function, name, document_->statistics);
    const std::string text = text_of(preset);
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) fail(file.parent_path().string(), ": cannot be made: ", error.message());
    write_file_atomically(file, std::as_bytes(std::span(text)));
    load();
    say("The transfer function is kept as " + name);
}

void PresetShelf::act(const RenamePreset& action)
{
    static_cast<void>(own(action.name));
    const std::string name(trimmed(action.to));
    const std::filesystem::path from = preset_file(folder(), action.name), to = free_file(name);
    std::error_code error;
    if (std::filesystem::exists(to, error)) fail("'", name, "' is kept already; expected a name that is free");
    std::filesystem::rename(from, to, error);
    if (error) fail(from.string(), ": cannot be renamed: ", error.message());
    load();
    say(sentence("The transfer function ", action.name, " is now called ", name));
}

void PresetShelf::act(const ForgetPreset& action)
{
    static_cast<void>(own(action.name));
    const std::filesystem::path file = preset_file(folder(), action.name);
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) fail(file.string(), ": cannot be removed: ", error.message());
    load();
    say("The transfer function " + action.name + " is no longer kept");
}

}  // namespace shvr::ui
