#pragma once
// Maps keys to shortcuts: a default set of keys with the user's changes. Pure; any thread.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/workbench/bindings/shortcuts.h"

namespace shvr::ui {

/// Number of stylus buttons that can be bound.
inline constexpr uint32_t MAX_BUTTONS = 8;

/// A key with its modifiers. Keys have names: "A", "7", "[", "F5", "PageUp", "Space"; "Stylus1" is the first button of
/// a stylus.
struct Chord {
    bool control = false, alt = false, shift = false;
    std::string key;
    auto operator<=>(const Chord&) const = default;
};
/// Parses "Ctrl+Shift+Z"; returns no value if the text is not a chord.
std::optional<Chord> chord_of(std::string_view text);
/// Returns the text that `chord_of` parses as this chord.
std::string text_of(const Chord& chord);
/// Returns the chord as displayed: "Ctrl + Shift + Z", "Page Up".
std::string in_words(const Chord& chord);

class Keymap {
public:
    using Changes = KeyChanges;
    /// Fails if an id is neither that of a shortcut nor an action as text (action_rows.h), or a text is not a chord.
    explicit Keymap(KeySet set = KeySet::modern, const Changes& changes = {});

    /// Returns the shortcuts bound to this chord: usually one, more if the user bound a chord twice. A shortcut that
    /// Shift slows down is found for its chord with and without Shift.
    std::vector<const Shortcut*> shortcuts_for(const Chord& chord) const;
    /// Returns the actions without a shortcut that the user bound to this chord.
    std::vector<Action> actions_for(const Chord& chord) const;
    /// Returns the chords of a shortcut.
    const std::vector<Chord>& chords_of(const Shortcut& shortcut) const;
    /// Returns the first chord of an action without a shortcut, as displayed; empty if there is none.
    std::string text_of_action(const std::string& action) const;
    /// An action that the user bound to keys.
    struct Bound {
        std::string text;  ///< the action as text, which identifies it
        Action action;
        std::vector<Chord> chords;
    };
    const std::vector<Bound>& bound() const { return bound_; }
    /// Returns the first chord as displayed; empty if there is none.
    std::string text_of(const Shortcut& shortcut) const;
    /// Returns the other shortcuts that share a chord with `shortcut`.
    std::vector<const Shortcut*> rivals_of(const Shortcut& shortcut) const;
    /// Returns one sentence for each chord that is bound to more than one shortcut.
    std::vector<std::string> conflicts() const;

private:
    std::vector<std::vector<Chord>> chords_;  ///< one list per shortcut, in the order of shortcuts()
    std::vector<Bound> bound_;
};

}  // namespace shvr::ui
