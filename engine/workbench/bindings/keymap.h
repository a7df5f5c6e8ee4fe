#pragma once
// Which keys mean which shortcuts: a set of keys as it ships, with a person's changes. Pure; any thread.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/workbench/bindings/shortcuts.h"

namespace shvr::ui {

/// Buttons of a stylus that can mean something.
inline constexpr uint32_t MAX_BUTTONS = 8;

/// A key with its modifiers. Keys are named: "A", "7", "[", "F5", "PageUp", "Space"; the first button of a stylus is
/// "Stylus1".
struct Chord {
    bool control = false, alt = false, shift = false;
    std::string key;
    auto operator<=>(const Chord&) const = default;
};
/// "Ctrl+Shift+Z"; nothing where the text is no chord.
std::optional<Chord> chord_of(std::string_view text);
/// The text that `chord_of` reads as this chord.
std::string text_of(const Chord& chord);
/// The same for people: "Ctrl + Shift + Z", "Page Up".
std::string in_words(const Chord& chord);

class Keymap {
public:
    using Changes = KeyChanges;
    /// Fails at an id that is no shortcut's and at a text that is no chord.
    explicit Keymap(KeySet set = KeySet::modern, const Changes& changes = {});

    /// The shortcuts that this press means; one, unless a person's changes give a chord twice. Where a shortcut is
    /// slowed by Shift, Shift may be down.
    std::vector<const Shortcut*> shortcuts_for(const Chord& chord) const;
    /// The chords of a shortcut.
    const std::vector<Chord>& chords_of(const Shortcut& shortcut) const;
    /// The first, in words; empty where there is none.
    std::string text_of(const Shortcut& shortcut) const;
    /// Others that have one of its chords.
    std::vector<const Shortcut*> rivals_of(const Shortcut& shortcut) const;
    /// Chords that mean more than one shortcut, each in a sentence.
    std::vector<std::string> conflicts() const;

private:
    std::vector<std::vector<Chord>> chords_;  ///< in the order of shortcuts()
};

}  // namespace shvr::ui
