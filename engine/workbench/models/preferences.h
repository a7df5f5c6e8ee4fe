#pragma once
// The user's choices for all scans: keys, theme and sizes, panel layout, and recently opened paths. Plain data; any
// thread. bindings/preferences_file.h reads and writes them.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/workbench/appearance/layout.h"
#include "engine/workbench/appearance/theme.h"

namespace shvr::ui {

/// Selects one of the two default sets of keys (bindings/shortcuts.h).
enum class KeySet { modern, thesis };
inline constexpr Spelling<KeySet> KEY_SETS[] = {{KeySet::modern, "modern"}, {KeySet::thesis, "thesis"}};
constexpr std::span<const Spelling<KeySet>> spellings_of(KeySet)
{
    return KEY_SETS;
}

/// Chords that replace the defaults, by the shortcut's id. A shortcut with an empty list has no key.
using KeyChanges = std::map<std::string, std::vector<std::string>>;

/// Selects whether a device that reports speeds (a SpaceMouse) moves the view or the probe.
enum class PuckMoves { view, probe };
inline constexpr Spelling<PuckMoves> PUCK_MOVES[] = {{PuckMoves::view, "view"}, {PuckMoves::probe, "probe"}};
constexpr std::span<const Spelling<PuckMoves>> spellings_of(PuckMoves)
{
    return PUCK_MOVES;
}

/// The haptic device to use, identified by data that do not depend on its USB port. Empty name: the first usable one.
struct ChosenDevice {
    std::string name, serial;
    bool operator==(const ChosenDevice&) const = default;
};

struct Preferences {
    static constexpr size_t MAX_RECENT = 12;
    static constexpr double MIN_FONT_PIXELS = 9.0, MAX_FONT_PIXELS = 32.0, MIN_SCALE = 0.5, MAX_SCALE = 4.0,
                            MIN_BUDGET_MIB = 16.0, MAX_BUDGET_MIB = 1048576.0;

    KeySet key_set = KeySet::modern;
    KeyChanges keys;                            ///< chords that differ from those of the key set
    KeyChanges unusable_keys;                   ///< changes with unknown shortcuts or chords, which the file keeps
    std::vector<std::filesystem::path> recent;  ///< newest first, each once
    Theme theme = Theme::dark;
    double font_pixels = 14.0;    ///< at a scale of 1
    std::optional<double> scale;  ///< scale of the whole interface; none: the scale of the screen
    /// Limits of device and host memory, in effect from the next start on; none: uses as much as is available.
    std::optional<double> budget_device_mib, budget_host_mib;
    WindowLayout layout;
    ChosenDevice device;
    PuckMoves puck = PuckMoves::view;
    int hints_seen = 0;  ///< number of first hints that the user dismissed, 0 ... 3 (bindings/hints.h)

    void note_opened(const std::filesystem::path& path);
    bool operator==(const Preferences&) const = default;
};

}  // namespace shvr::ui
