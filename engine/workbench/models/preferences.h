#pragma once
// What a person keeps for all scans: keys, theme and sizes, where panels are, and what was opened last. Plain data; any
// thread. bindings/preferences_file.h reads and writes it.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/workbench/appearance/layout.h"
#include "engine/workbench/appearance/theme.h"

namespace shvr::ui {

/// Which of the two sets of keys that ship is used (bindings/shortcuts.h).
enum class KeySet { modern, thesis };
inline constexpr Spelling<KeySet> KEY_SETS[] = {{KeySet::modern, "modern"}, {KeySet::thesis, "thesis"}};
constexpr std::span<const Spelling<KeySet>> spellings_of(KeySet)
{
    return KEY_SETS;
}

/// Chords by the ids of shortcuts, in place of those that ship; an empty list leaves a shortcut without a key.
using KeyChanges = std::map<std::string, std::vector<std::string>>;

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
    KeyChanges keys;                            ///< in place of those of the set
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

}  // namespace shvr::ui
