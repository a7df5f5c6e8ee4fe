#include "engine/workbench/bindings/palette.h"

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/session/session_keys.h"
#include "engine/session/session_patch.h"
#include "engine/session/words/number_words.h"
#include "engine/session/words/setting_labels.h"
#include "engine/session/words/typed_number.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/bindings/palette_lists.h"

namespace shvr::ui {

namespace {

constexpr size_t MAX_COMPLETIONS = 40, MAX_VALUES = 6;

bool is_action_id(std::string_view word)
{
    return std::ranges::any_of(action_rows(), [&](const ActionRow& row) { return row.id == word; });
}

/// Returns the table of settings. The table never changes, so it is built only once.
const std::vector<SessionKey>& keys_of_settings()
{
    static const std::vector<SessionKey> KEYS = keys_of([](Fields& f) {
        static Session session;
        setting_fields(f, session);
    });
    return KEYS;
}

/// Returns a setting as it is called in the window: "Ambient light".
std::string title_of(const SessionKey& key)
{
    const SettingLabel* const label = label_of_setting(key.name);
    return label ? capitalised(label->label) : key.name;
}

/// Returns whether a setting's label, key or meaning has all the words. Words do not find one of many, "points.N".
bool is_found(const SessionKey& key, std::string_view words)
{
    std::string where = title_of(key) + ' ' + key.name + ' ' + key.meaning;
    std::ranges::replace_if(
        where, [](char each) { return each == '.' || each == '_'; }, ' ');
    const bool is_one_of_many = key.name.find(".N") != std::string::npos || key.name.find("NAME") != std::string::npos;
    return !is_one_of_many && has_words(where, words);
}

/// Returns whether the action needs arguments after its id in order to be valid.
bool takes_arguments(const std::string& id)
{
    try {
        static_cast<void>(action_of_text(id));
        return false;
    } catch (const Error&) {
        return true;
    }
}

/// Returns an entry for a typed action, with the reason if the text is not a valid action or the action is unavailable.
template <class Make>
PaletteEntry typed_exactly(const Model& model, const std::string& text, const char* group, const Make& make)
{
    PaletteEntry entry{.name = text, .group = group};
    try {
        entry.action = make(text);
        entry.why_not = why_not(model, *entry.action);
        if (const Set* const set = entry.action->as<Set>(); set && entry.why_not.empty())
            static_cast<void>(patched(model.session, set->patch));
    } catch (const Error& error) {
        entry.why_not = error.what();
    }
    return entry;
}

/// Returns the text with a decimal point in each of its values, "key=value", that has a decimal comma.
std::string with_decimal_points(std::string_view text)
{
    std::string changed;
    for (const std::string_view word : words_of(text)) {
        const size_t value = word.find('=') + 1;
        changed += sentence(changed.empty() ? "" : " ", word.substr(0, value), with_decimal_point(word.substr(value)));
    }
    return changed;
}

/// The same, with decimal points where it is not valid with decimal commas. `make`: returns the action of a text.
template <class Make>
PaletteEntry typed(const Model& model, std::string_view text, const char* group, const Make& make)
{
    PaletteEntry entry = typed_exactly(model, std::string(text), group, make);
    if (entry.why_not.empty()) return entry;
    PaletteEntry with_points = typed_exactly(model, with_decimal_points(text), group, make);
    return with_points.why_not.empty() ? with_points : entry;
}

Action set_of(const std::string& text)
{
    return Set{patch_of(text)};
}

/// Adds the opening of a typed address. The entry's name lacks the address's query, which is a credential.
void add_address(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    PaletteEntry entry{.group = "Volume at an address"};
    try {
        const std::string address = take_query(std::string(text));
        entry.name = "Open " + address;
        static_cast<void>(parse_address(address));
        entry.action = Open{address};
        entry.why_not = why_not(model, *entry.action);
    } catch (const Error& error) {
        entry.name = "Open an address";
        entry.why_not = error.what();
    }
    entries.push_back(std::move(entry));
}

void add_typed(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    if (is_address(text)) return add_address(entries, model, text);
    const std::string_view first = text.substr(0, text.find(' '));
    const size_t equals = text.find('=');
    if (is_action_id(first)) {
        entries.push_back(typed(model, text, "Action", action_of_text));
    } else if (equals != std::string_view::npos && equals > 0 && text.substr(0, equals).find(' ') == text.npos) {
        entries.push_back(typed(model, text, "Setting", set_of));
    }
}

void add_shortcuts(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    for (const Shortcut& shortcut : shortcuts()) {
        const std::string keys = model.keymap.text_of(shortcut);
        if (!has_words(sentence(shortcut.name, ' ', shortcut.group, ' ', shortcut.id, ' ', keys), text)) continue;
        const bool is_held = shortcut.mode == Shortcut::Mode::while_held;
        entries.push_back({.name = shortcut.name,
                           .group = shortcut.group,
                           .keys = keys,
                           .why_not = is_held ? "goes on while its key is held" : why_not(model, shortcut),
                           .action = shortcut.action(model, 1.0),
                           .bound_as = shortcut.id});
    }
}

/// The settings of a session, as JSON.
class PresentValues {
public:
    explicit PresentValues(Session session)
        : settings_(write_fields({}, [&](Fields& f) { setting_fields(f, session); }), "settings", LIMITS)
    {}
    /// Returns the value of a key as JSON; empty: it has none.
    std::string of(std::string_view key) const
    {
        JsonNode node = settings_.root();
        for (size_t begin = 0; begin <= key.size();) {
            const size_t end = std::min(key.find('.', begin), key.size());
            node = node[key.substr(begin, end - begin)];
            if (!node.exists()) return {};
            begin = end + 1;
        }
        return node.dump();
    }

private:
    static constexpr JsonLimits LIMITS{.depth = 16, .expected = "settings, an object"};
    JsonDocument settings_;
};

/// Returns the values that a setting may have, if they are few words: "true, false", or names in quotes.
std::vector<std::string> few_values(const SessionKey& key)
{
    if (key.allowed.find("true, false") != std::string::npos) return {"true", "false"};
    std::vector<std::string> values;
    for (size_t at = key.allowed.find('"'); at != std::string::npos; at = key.allowed.find('"', at)) {
        const size_t end = key.allowed.find('"', at + 1);
        if (end == std::string::npos) break;
        values.push_back(key.allowed.substr(at, end + 1 - at));
        at = end + 1;
    }
    return values;
}

/// Adds the other values of settings that have few and may have those now, and asks for the value of the others.
void add_settings(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    constexpr size_t MAX_SETTINGS = 24;
    std::optional<PresentValues> present;
    size_t left = MAX_SETTINGS;
    for (const SessionKey& key : keys_of_settings()) {
        if (left == 0) return;
        if (!is_found(key, text)) continue;
        --left;
        if (!present) present.emplace(model.session);
        const std::string now = present->of(key.name), title = title_of(key);
        const std::string about =
            "Setting: " + key.name + (now.empty() ? "" : ", now " + value_in_words(key.name, now));
        for (const std::string& value : few_values(key)) {
            if (value == now) continue;
            PaletteEntry entry = typed_exactly(model, sentence(key.name, '=', value), "", set_of);
            if (!entry.why_not.empty()) continue;
            entry.name = title + ": " + value_in_words(key.name, value);
            entry.group = about;
            entries.push_back(std::move(entry));
        }
        if (few_values(key).empty() && !key.allowed.empty())
            entries.push_back({.name = title, .group = about, .completion = key.name + '='});
    }
}

/// Adds the settings that match the words before a typed value, as in "ambient 0.4".
void add_values(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    const size_t space = text.rfind(' ');
    if (space == std::string_view::npos) return;
    const std::string_view words = trimmed(text.substr(0, space)), value = text.substr(space + 1);
    size_t left = MAX_VALUES;
    for (const SessionKey& key : keys_of_settings()) {
        if (!is_found(key, words)) continue;
        PaletteEntry entry = typed(model, sentence(key.name, '=', value), "", set_of);
        if (!entry.why_not.empty()) continue;
        entry.name = sentence(title_of(key), ": ", entry.name.substr(key.name.size() + 1));
        entry.group = "Setting: " + key.name;
        entries.push_back(std::move(entry));
        if (--left == 0) return;
    }
}

/// Adds actions found by the beginning of their id, and settings found by the beginning of their key.
void add_completions(std::vector<PaletteEntry>& entries, std::string_view text)
{
    if (text.empty() || text.find('=') != std::string_view::npos) return;
    size_t left = MAX_COMPLETIONS;
    const auto add = [&](const std::string& name, const std::string& says, char next) {
        if (left == 0) return;
        --left;
        entries.push_back({.name = name, .group = says, .completion = name + next});
    };
    for (const ActionRow& row : action_rows())
        if (std::string_view(row.id).starts_with(text) && (text != row.id || takes_arguments(row.id)))
            add(row.id, row.meaning, ' ');
    const bool is_key = text.find('.') != std::string_view::npos;
    for (const SessionKey& key : keys_of_settings())
        if (is_key && key.name.starts_with(text)) add(key.name, sentence(key.meaning, "; ", key.allowed), '=');
}

}  // namespace

bool has_words(std::string_view where, std::string_view text)
{
    const std::string lower = lower_case(where), wanted = lower_case(text);
    return std::ranges::all_of(words_of(wanted),
                               [&](std::string_view word) { return lower.find(word) != std::string::npos; });
}

std::vector<PaletteEntry> palette_entries(const Model& model, std::string_view text)
{
    text = trimmed(text);
    std::vector<PaletteEntry> entries, as_typed;
    add_typed(as_typed, model, text);
    // An unavailable typed action may also be the beginning of a shortcut's name, so shortcuts are listed before it.
    const bool is_done = !as_typed.empty() && as_typed.front().why_not.empty();
    if (is_done) entries = as_typed;
    add_shortcuts(entries, model, text);
    if (!text.empty() && !is_done) {
        add_values(entries, model, text);
        add_listed(entries, model, text);
        if (model.is_open) add_settings(entries, model, text);
    }
    // If there are entries, hides the error that an action lacks its arguments: add_completions() offers to add them.
    if (!entries.empty() && text.find_first_of(" =") == text.npos) as_typed.clear();
    if (!is_done) entries.insert(entries.end(), as_typed.begin(), as_typed.end());
    add_completions(entries, text);
    for (PaletteEntry& entry : entries) {
        if (!entry.action || !entry.bound_as.empty()) continue;
        entry.bound_as = text_of(*entry.action);
        entry.keys = model.keymap.text_of_action(entry.bound_as);
    }
    return entries;
}

}  // namespace shvr::ui
