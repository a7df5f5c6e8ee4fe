#pragma once
// What a person keeps for all scans: keys, theme and sizes, where panels are, and what was opened last. One JSON file,
// $XDG_CONFIG_HOME/shvr/ preferences.json, written whole or not at all. Any thread.

#include <filesystem>
#include <vector>

#include "ui/workbench/appearance/layout.h"
#include "ui/workbench/appearance/theme.h"
#include "ui/workbench/bindings/keymap.h"

namespace shvr::ui {

/// What a device that states speeds (a SpaceMouse) moves.
enum class PuckMoves { view, probe };
inline constexpr Spelling<PuckMoves> PUCK_MOVES[] = {{PuckMoves::view, "view"}, {PuckMoves::probe, "probe"}};
constexpr std::span<const Spelling<PuckMoves>> spellings_of(PuckMoves)
{
    return PUCK_MOVES;
}

/// A haptic device by what stays the same when it is plugged in elsewhere. Without a name: the first that can be used.
struct ChosenDevice {
    std::string name, serial;
    bool operator==(const ChosenDevice&) const = default;
};

struct Preferences {
    static constexpr size_t MAX_RECENT = 12;
    static constexpr double MIN_FONT_PIXELS = 9.0, MAX_FONT_PIXELS = 32.0, MIN_SCALE = 0.5, MAX_SCALE = 4.0,
                            MIN_BUDGET_MIB = 16.0, MAX_BUDGET_MIB = 1048576.0;

    KeySet key_set = KeySet::modern;
    Keymap::Changes keys;                       ///< in place of those of the set
    std::vector<std::filesystem::path> recent;  ///< newest first, each once
    Theme theme = Theme::dark;
    double font_pixels = 14.0;    ///< at a scale of 1
    std::optional<double> scale;  ///< of everything; none: the screen's
    /// Of the device's and of the host's memory, from the next start on; none: as much as fits.
    std::optional<double> budget_device_mib, budget_host_mib;
    WindowLayout layout;
    ChosenDevice device;
    PuckMoves puck = PuckMoves::view;
    int hints_seen = 0;  ///< of the three for a first start (appearance/hints.h)

    void note_opened(const std::filesystem::path& path);
    bool operator==(const Preferences&) const = default;
};

/// Where they are kept; empty where the environment names no home.
std::filesystem::path preferences_file();
/// Those of a file that does not exist are the defaults. Fails at unknown keys, shortcuts and chords, naming file, key,
/// value and what was expected.
Preferences load_preferences(const std::filesystem::path& file);
/// With a merge patch of that file applied, as in {"theme": "light"}; null takes what ships. Fails as reading does.
Preferences patched(const Preferences& preferences, std::string_view patch);
/// The patch that makes a change of a panel's place; `change` may set any of its parts.
std::string patch_of_panel(const std::string& id, const PanelLayout& change);
/// The patch that says where a window is (layout.h), in font sizes.
std::string patch_of_window(const std::string& id, const glm::dvec2& at, const glm::dvec2& size);
/// Makes the folder where it is missing.
void save_preferences(const std::filesystem::path& file, const Preferences& preferences);

}  // namespace shvr::ui
