// A person's own transfer functions, kept beside the preferences; and runs of the device's passes in files.

#include <algorithm>

#include "engine/base/atomic_file.h"
#include "ui/workbench/workbench.h"

namespace shvr::ui {

std::filesystem::path Workbench::preset_folder() const
{
    if (options_.preferences.empty())
        fail("no folder for what is kept is known; expected HOME or XDG_CONFIG_HOME in the environment");
    return options_.preferences.parent_path() / "transfer_functions";
}

/// Those that ship, then a person's own.
void Workbench::load_presets()
{
    presets_.clear();
    try {
        presets_ = transfer_presets();
    } catch (const Error& error) {
        say(error.what(), Weight::warning);
    }
    if (options_.preferences.empty()) return;
    std::vector<std::string> warnings;
    for (TransferPreset& preset : own_transfer_presets(preset_folder(), warnings))
        presets_.push_back(std::move(preset));
    for (std::string& warning : warnings) say(std::move(warning), Weight::warning);
}

const TransferPreset& Workbench::own_preset(const std::string& name) const
{
    const auto found = std::ranges::find_if(
        presets_, [&](const TransferPreset& preset) { return preset.is_own && preset.name == name; });
    if (found == presets_.end()) fail("no transfer function is kept as '", name, "'; expected one that the list shows");
    return *found;
}

/// The file of a name that ships is never made: two would look the same in the list.
std::filesystem::path Workbench::free_preset_file(const std::string& name) const
{
    const std::filesystem::path file = preset_file(preset_folder(), name);
    if (std::ranges::any_of(presets_, [&](const TransferPreset& each) { return !each.is_own && each.name == name; }))
        fail("'", name, "' is a transfer function that ships; expected another name");
    return file;
}

void Workbench::act(const KeepPreset& action)
{
    const std::filesystem::path file = free_preset_file(action.name);
    const TransferPreset preset = preset_of(document_->session.transfer_function, action.name, document_->statistics);
    const std::string text = text_of(preset);
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) fail(file.parent_path().string(), ": cannot be made: ", error.message());
    write_file_atomically(file, std::as_bytes(std::span(text)));
    load_presets();
    say("The transfer function is kept as " + action.name);
}

void Workbench::act(const RenamePreset& action)
{
    static_cast<void>(own_preset(action.name));
    const std::filesystem::path from = preset_file(preset_folder(), action.name), to = free_preset_file(action.to);
    std::error_code error;
    if (std::filesystem::exists(to, error)) fail("'", action.to, "' is kept already; expected a name that is free");
    std::filesystem::rename(from, to, error);
    if (error) fail(from.string(), ": cannot be renamed: ", error.message());
    load_presets();
    say(sentence("The transfer function ", action.name, " is now called ", action.to));
}

void Workbench::act(const ForgetPreset& action)
{
    static_cast<void>(own_preset(action.name));
    const std::filesystem::path file = preset_file(preset_folder(), action.name);
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) fail(file.string(), ": cannot be removed: ", error.message());
    load_presets();
    say("The transfer function " + action.name + " is no longer kept");
}

void Workbench::act(const TakePreset& action)
{
    Session after = document_->session;
    const TransferPreset preset = read_transfer_preset(action.path);
    after.transfer_function = transfer_function_of(preset, document_->statistics);
    take_session(std::move(after));
    say("Transfer function: " + preset.name);
}

// ---- The device's passes --------------------------------------------------------------------------------------------

void Workbench::act(const ShowPasses& action)
{
    shows_passes_ = action.on;
}

void Workbench::act(const SavePasses& action)
{
    save_pass_run(action.path, document_->screen.pass_times());
    say("GPU passes are in " + action.path.string());
}

void Workbench::act(const ComparePasses& action)
{
    if (action.path.empty()) {
        compared_passes_.reset();
        return say("GPU passes are compared with nothing");
    }
    compared_passes_ = read_pass_run(action.path);
    say(sentence("GPU passes are compared with ", action.path.string(), ", which has ", compared_passes_->passes.size(),
                 " of them"));
}

}  // namespace shvr::ui
