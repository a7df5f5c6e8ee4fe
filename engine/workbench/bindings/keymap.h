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

/// Parses the chords of a shortcut or an action, `id`; fails with the id if a text is not a chord.
std::vector<Chord> chords_of(const std::string& id, const std::vector<std::string>& texts);

/// Returns the name of a shortcut's id, or of an action as text; fails if the id is neither.
std::string name_of_binding(const std::string& id);

/// Maps a chord to one thing, even if several are bound to it: to an action of the user, then to a shortcut whose keys
/// the user changed, then to another one.
class Keymap {
public:
    using Changes = KeyChanges;
    /// Fails if an id is neither that of a shortcut nor an action as text (action_rows.h), or a text is not a chord.
    explicit Keymap(KeySet set = KeySet::modern, const Changes& changes = {});

    /// Returns the shortcut that this chord stands for; null if there is none, or the chord stands for an action. A
    /// shortcut that Shift slows down is found for its chord with and without Shift.
    const Shortcut* shortcut_for(const Chord& chord) const;
    /// Returns the action without a shortcut that the user bound to this chord; null if there is none.
    const Action* action_for(const Chord& chord) const;
    /// Returns the ids of all that is bound to exactly this chord: shortcuts, and actions as text.
    std::vector<std::string> holders_of(const Chord& chord) const;
    /// Returns the chords of a shortcut.
    const std::vector<Chord>& chords_of(const Shortcut& shortcut) const;
    /// Returns the chords of a shortcut's id, or of an action as text; none if it has none.
    std::vector<Chord> chords_of(const std::string& id) const;
    /// Returns the first chord of an action without a shortcut, as displayed; empty if there is none.
    std::string text_of_action(const std::string& action) const;
    /// An action that the user bound to keys.
    struct Bound {
        std::string text;  ///< the action as text, which identifies it
        std::string name;  ///< as a person calls it
        Action action;
        std::vector<Chord> chords;
    };
    const std::vector<Bound>& bound() const { return bound_; }
    /// Returns the first chord as displayed; empty if there is none.
    std::string text_of(const Shortcut& shortcut) const;
    /// Returns the other shortcuts that share a chord with `shortcut`.
    std::vector<const Shortcut*> rivals_of(const Shortcut& shortcut) const;
    /// Returns one sentence for each chord that is bound to more than one thing.
    std::vector<std::string> conflicts() const;

private:
    int rank_of(const Shortcut& shortcut, const Chord& chord) const;

    std::vector<std::vector<Chord>> chords_;  ///< one list per shortcut, in the order of shortcuts()
    std::vector<bool> are_changed_;           ///< whether the user changed its keys, in the same order
    std::vector<Bound> bound_;
};

}  // namespace shvr::ui
