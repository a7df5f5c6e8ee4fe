#pragma once
// Transfer functions that the user saves for all scans, in a folder next to the file of preferences.

#include "engine/session/transfer_presets.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class PresetShelf : public Service {
public:
    explicit PresetShelf(Desk& desk) : Service(desk) {}
    void act(const KeepPreset& action);
    void act(const RenamePreset& action);
    void act(const ForgetPreset& action);

    /// Loads the presets that ship with the program, then the user's own.
    void load();
    PresetModel model() const { return {.presets = presets_}; }

private:
    std::filesystem::path folder() const;
    const TransferPreset& own(const std::string& name) const;
    std::filesystem::path free_file(const std::string& name) const;

    std::vector<TransferPreset> presets_;
};

}  // namespace shvr::ui
