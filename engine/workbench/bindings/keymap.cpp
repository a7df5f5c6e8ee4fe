#include "engine/workbench/bindings/keymap.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/bindings/action_names.h"

namespace shvr::ui {

namespace {

/// Keys with names of several letters, each with its display name.
constexpr std::pair<const char*, const char*> NAMED_KEYS[] = {
    {"Space", "Space"}, {"Delete", "Delete"},       {"Insert", "Insert"},      {"Home", "Home"},
    {"End", "End"},     {"PageUp", "Page Up"},      {"PageDown", "Page Down"}, {"Up", "Up"},
    {"Down", "Down"},   {"Left", "Left"},           {"Right", "Right"},        {"Tab", "Tab"},
    {"Enter", "Enter"}, {"Backspace", "Backspace"}, {"Escape", "Escape"},      {"Pause", "Pause"}};
constexpr std::string_view STYLUS = "Stylus";

/// "Stylus1" to "Stylus8"
bool is_stylus_button(std::string_view text)
{
    return text.starts_with(STYLUS) && text.size() == STYLUS.size() + 1 && text.back() >= '1' &&
           text.back() < char('1' + MAX_BUTTONS);
}

bool is_key(std::string_view text)
{
    if (text.size() == 1) return text[0] > ' ' && text[0] < 127 && !(text[0] >= 'a' && text[0] <= 'z');
    if (text[0] == 'F' && text.size() <= 3)
        return std::ranges::all_of(text.substr(1), [](char c) { return c >= '0' && c <= '9'; }) && text[1] != '0' &&
               std::stoi(std::string(text.substr(1))) <= 25;
    return is_stylus_button(text) ||
           std::ranges::any_of(NAMED_KEYS, [&](const auto& named) { return text == named.first; });
}

bool take(std::string_view& text, std::string_view prefix)
{
    if (!text.starts_with(prefix)) return false;
    text.remove_prefix(prefix.size());
    return true;
}

std::vector<Chord> chords_in(std::string_view text)
{
    std::vector<Chord> chords;
    for (const std::string_view word : words_of(text)) {
        const std::optional<Chord> chord = chord_of(word);
        SHVR_CHECK(chord, text);
        chords.push_back(*chord);
    }
    return chords;
}

/// Returns the action that an id other than a shortcut's states.
Action action_of_id(const std::string& id)
{
    try {
        return action_of_text(id);
    } catch (const Error&) {
        fail("keys: '", id, "' is no shortcut; expected one listed in the help window, or an action");
    }
}

bool means(const Shortcut& shortcut, const Chord& bound, Chord pressed)
{
    if (shortcut.is_slowed()) pressed.shift = bound.shift;
    return bound == pressed;
}

}  // namespace

std::optional<Chord> chord_of(std::string_view text)
{
    Chord chord;
    chord.control = take(text, "Ctrl+");
    chord.alt = take(text, "Alt+");
    chord.shift = take(text, "Shift+");
    if (text.empty() || !is_key(text)) return std::nullopt;
    chord.key = text;
    return chord;
}

std::string text_of(const Chord& chord)
{
    return sentence(chord.control ? "Ctrl+" : "", chord.alt ? "Alt+" : "", chord.shift ? "Shift+" : "", chord.key);
}

std::string in_words(const Chord& chord)
{
    std::string text;
    if (chord.control) text += "Ctrl + ";
    if (chord.alt) text += "Alt + ";
    if (chord.shift) text += "Shift + ";
    if (is_stylus_button(chord.key)) return text + "stylus button " + chord.key.back();
    const auto named = std::ranges::find_if(NAMED_KEYS, [&](const auto& each) { return chord.key == each.first; });
    return text + (named == std::end(NAMED_KEYS) ? chord.key : named->second);
}

std::vector<Chord> chords_of(const std::string& id, const std::vector<std::string>& texts)
{
    std::vector<Chord> chords;
    for (const std::string& text : texts) {
        const std::optional<Chord> chord = chord_of(text);
        if (!chord) fail("keys: ", id, " is '", text, "'; expected a key such as Ctrl+Z, F5, PageUp or [");
        chords.push_back(*chord);
    }
    return chords;
}

std::string name_of_binding(const std::string& id)
{
    const Shortcut* const shortcut = shortcut_named(id);
    return shortcut ? shortcut->name : name_of(action_of_id(id));
}

Keymap::Keymap(KeySet set, const Changes& changes)
{
    for (const Shortcut& shortcut : shortcuts()) chords_.push_back(chords_in(shortcut.keys[size_t(set)]));
    are_changed_.resize(chords_.size());
    for (const auto& [id, texts] : changes) {
        const std::vector<Chord> chords = ui::chords_of(id, texts);
        if (const Shortcut* const shortcut = shortcut_named(id)) {
            const size_t index = size_t(shortcut - shortcuts().data());
            chords_[index] = chords;
            are_changed_[index] = true;
        } else {
            const Action action = action_of_id(id);
            bound_.push_back({id, name_of(action), action, chords});
        }
    }
}

/// Returns how closely a shortcut is bound to the chord; 0: not at all.
int Keymap::rank_of(const Shortcut& shortcut, const Chord& chord) const
{
    const std::vector<Chord>& chords = chords_of(shortcut);
    const bool is_changed = are_changed_[size_t(&shortcut - shortcuts().data())];
    if (std::ranges::find(chords, chord) != chords.end()) return is_changed ? 3 : 2;
    // It is bound to the chord without Shift, which slows it.
    return std::ranges::any_of(chords, [&](const Chord& bound) { return means(shortcut, bound, chord); }) ? 1 : 0;
}

const Shortcut* Keymap::shortcut_for(const Chord& chord) const
{
    if (action_for(chord)) return nullptr;
    const Shortcut* found = nullptr;
    int highest = 0;
    for (const Shortcut& shortcut : shortcuts()) {
        const int rank = rank_of(shortcut, chord);
        if (rank <= highest) continue;
        found = &shortcut;
        highest = rank;
    }
    return found;
}

const Action* Keymap::action_for(const Chord& chord) const
{
    for (const Bound& each : bound_)
        if (std::ranges::find(each.chords, chord) != each.chords.end()) return &each.action;
    return nullptr;
}

std::vector<std::string> Keymap::holders_of(const Chord& chord) const
{
    const auto has_it = [&](const std::vector<Chord>& chords) {
        return std::ranges::find(chords, chord) != chords.end();
    };
    std::vector<std::string> ids;
    for (const Shortcut& shortcut : shortcuts())
        if (has_it(chords_of(shortcut))) ids.emplace_back(shortcut.id);
    for (const Bound& each : bound_)
        if (has_it(each.chords)) ids.push_back(each.text);
    return ids;
}

std::string Keymap::text_of_action(const std::string& action) const
{
    const auto found = std::ranges::find(bound_, action, &Bound::text);
    return found == bound_.end() || found->chords.empty() ? std::string() : in_words(found->chords.front());
}

const std::vector<Chord>& Keymap::chords_of(const Shortcut& shortcut) const
{
    return chords_[size_t(&shortcut - shortcuts().data())];
}

std::vector<Chord> Keymap::chords_of(const std::string& id) const
{
    if (const Shortcut* const shortcut = shortcut_named(id)) return chords_of(*shortcut);
    const auto found = std::ranges::find(bound_, id, &Bound::text);
    return found == bound_.end() ? std::vector<Chord>() : found->chords;
}

std::string Keymap::text_of(const Shortcut& shortcut) const
{
    const std::vector<Chord>& chords = chords_of(shortcut);
    return chords.empty() ? std::string() : in_words(chords.front());
}

std::vector<const Shortcut*> Keymap::rivals_of(const Shortcut& shortcut) const
{
    std::vector<const Shortcut*> rivals;
    for (const Shortcut& other : shortcuts())
        if (&other != &shortcut &&
            std::ranges::find_first_of(chords_of(other), chords_of(shortcut)) != chords_of(other).end())
            rivals.push_back(&other);
    return rivals;
}

std::vector<std::string> Keymap::conflicts() const
{
    std::map<Chord, std::vector<std::string>> bound;
    for (const Shortcut& shortcut : shortcuts())
        for (const Chord& chord : chords_of(shortcut)) bound[chord].emplace_back(shortcut.name);
    for (const Bound& each : bound_)
        for (const Chord& chord : each.chords) bound[chord].push_back(each.name);
    std::vector<std::string> sentences;
    for (const auto& [chord, wanted] : bound) {
        if (wanted.size() < 2) continue;
        std::string names;
        for (const std::string& name : wanted) names += sentence(names.empty() ? "" : " and for ", '\'', name, '\'');
        sentences.push_back(in_words(chord) + " stands for " + names + "; change one of them");
    }
    return sentences;
}

}  // namespace shvr::ui
