#pragma once
// Everything that a model of the workbench refers to, for tests of panels, keys and the mouse.

#include <filesystem>

#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/models/preferences.h"

namespace shvr::test {

struct World {
    Session session;
    VolumeInfo volume;
    VolumeStatistics statistics;
    Camera camera;
    std::vector<Screen::Part> panes;
    std::vector<TransferPreset> presets;
    TraceGraph trace;
    std::filesystem::path path;
    ui::MessageLog messages;
    ui::Keymap keymap;
    ui::Preferences preferences;
    ui::Model model{{.is_open = true,
                     .session = session,
                     .volume = volume,
                     .statistics = statistics,
                     .camera = camera,
                     .session_path = path,
                     .messages = messages},
                    {.panes = panes},
                    {},
                    {},
                    {},
                    {},
                    {},
                    {.trace = trace},
                    {},
                    {},
                    {},
                    {},
                    {},
                    {.keymap = keymap, .preferences = preferences},
                    {.presets = presets},
                    {},
                    {}};
};

}  // namespace shvr::test
