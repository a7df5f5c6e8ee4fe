#include "engine/workbench/bindings/keymap.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/workbench/actions/action_rows.h"

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

std::vector<Chord> chords_of_change(const std::string& id, const std::vector<std::string>& texts)
{
    std::vector<Chord> chords;
    for (const std::string& text : texts) {
        const std::optional<Chord> chord = chord_of(text);
        if (!chord) fail("keys: ", id, " is '", text, "'; expected a key such as Ctrl+Z, F5, PageUp or [");
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

Keymap::Keymap(KeySet set, const Changes& changes)
{
    for (const Shortcut& shortcut : shortcuts()) chords_.push_back(chords_in(shortcut.keys[size_t(set)]));
    for (const auto& [id, texts] : changes) {
        const std::vector<Chord> chords = chords_of_change(id, texts);
        if (const Shortcut* const shortcut = shortcut_named(id))
            chords_[size_t(shortcut - shortcuts().data())] = chords;
        else
            bound_.push_back({id, action_of_id(id), chords});
    }
}

std::vector<const Shortcut*> Keymap::shortcuts_for(const Chord& chord) const
{
    std::vector<const Shortcut*> found;
    for (const Shortcut& shortcut : shortcuts())
        if (std::ranges::any_of(chords_of(shortcut), [&](const Chord& bound) { return means(shortcut, bound, chord); }))
            found.push_back(&shortcut);
    // If a shortcut is bound to the exact chord, drops shortcuts that are bound without Shift and only slowed by it.
    const auto is_exact = [&](const Shortcut* shortcut) {
        return std::ranges::find(chords_of(*shortcut), chord) != chords_of(*shortcut).end();
    };
    if (std::ranges::any_of(found, is_exact))
        std::erase_if(found, [&](const Shortcut* each) { return !is_exact(each); });
    return found;
}

std::vector<Action> Keymap::actions_for(const Chord& chord) const
{
    std::vector<Action> found;
    for (const Bound& each : bound_)
        if (std::ranges::find(each.chords, chord) != each.chords.end()) found.push_back(each.action);
    return found;
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
        for (const Chord& chord : each.chords) bound[chord].push_back(each.text);
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
