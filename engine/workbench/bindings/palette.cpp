#include "engine/workbench/bindings/palette.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/session/session_keys.h"
#include "engine/session/session_patch.h"
#include "engine/session/words/number_words.h"
#include "engine/session/words/setting_labels.h"
#include "engine/session/words/typed_number.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/bindings/action_names.h"
#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/bindings/palette_lists.h"
#include "engine/workbench/models/preference_rows.h"

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

/// Returns the panels' words for a setting, where they are not its label's.
std::string_view words_in_panels(const SessionKey& key)
{
    const SettingLabel* const label = label_of_setting(key.name);
    return label ? label->in_panels : std::string_view();
}

/// Returns a setting's label, and the panels' words for it.
std::string called(const SessionKey& key)
{
    return title_of_setting(key.name) + ' ' + std::string(words_in_panels(key));
}

/// Returns the description of a setting, next to its name.
std::string about(const SessionKey& key)
{
    const std::string_view words = words_in_panels(key);
    return words.empty() ? "Setting: " + key.name : sentence("Setting: ", key.name, " (", words, ')');
}

/// Returns whether a setting's label, key or meaning has all the words. Words do not find one of many, "points.N".
bool is_found(const SessionKey& key, std::string_view words)
{
    std::string where = called(key) + ' ' + key.name + ' ' + key.meaning;
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
        entry.action.reset();
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

/// Adds an action typed as text, its id or its id and arguments, or a setting typed as "key=value".
void add_typed(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    if (is_address(text)) return add_address(entries, model, text);
    const size_t equals = text.find('='), end = std::min(text.find(' '), text.size());
    const std::string first = lower_case(text.substr(0, end));
    const bool has_values = equals != std::string_view::npos;
    if (is_action_id(first) && (has_values || end == text.size()))
        entries.push_back(typed(model, first + std::string(text.substr(end)), "Action", action_of_text));
    else if (has_values && equals > 0 && equals < end)
        entries.push_back(
            typed(model, lower_case(text.substr(0, equals)) + std::string(text.substr(equals)), "Setting", set_of));
}

/// Returns words for what a dialog is about, which its name lacks; none for most.
std::string_view further_words(std::string_view id)
{
    constexpr std::pair<std::string_view, std::string_view> WORDS[]{
        {"load_annotation", "mask labels trace density offsets transfer function mesh look"},
        {"export_work", "mask labels trace measures measurements distances csv table surface mesh annotation"},
        {"import_scan", "volume crop downscale"},
        {"correct_spacing", "unit voxel size micrometre"},
        {"open_with_options", "budget memory level raw spacing"},
        {"figure", "picture image publication clipboard png tiff"},
        {"movie", "video animation turntable webm mp4 frames"},
        {"screenshot", "picture image png"},
        {"compare", "evaluate dice error"}};
    const auto found = std::ranges::find(WORDS, id, &std::pair<std::string_view, std::string_view>::first);
    return found == std::end(WORDS) ? std::string_view() : found->second;
}

void add_shortcuts(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    for (const Shortcut& shortcut : shortcuts()) {
        const std::string keys = model.keymap.text_of(shortcut);
        const std::string words =
            sentence(shortcut.name, ' ', shortcut.group, ' ', shortcut.id, ' ', keys, ' ', further_words(shortcut.id));
        if (!has_words(words, text)) continue;
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

bool is_flag(const SessionKey& key)
{
    return key.allowed.find("true, false") != std::string::npos;
}

/// Returns the names that a setting may have as its value, or "true" and "false".
std::vector<std::string> few_values(const SessionKey& key)
{
    if (is_flag(key)) return {"true", "false"};
    std::vector<std::string> values;
    for (size_t at = key.allowed.find('"'); at != std::string::npos; at = key.allowed.find('"', at)) {
        const size_t end = key.allowed.find('"', at + 1);
        if (end == std::string::npos) break;
        if (key.allowed[at + 1] != '#') values.push_back(key.allowed.substr(at, end + 1 - at));  // "#rrggbb"
        at = end + 1;
    }
    return values;
}

/// Returns whether a setting may have other values than those of few_values().
bool has_more_values(const SessionKey& key)
{
    return !key.allowed.empty() && !is_flag(key) && (few_values(key).empty() || !key.allowed.starts_with("`\""));
}

/// Adds the values of settings that have few and may have those now, and asks for the value of the others. A flag has
/// only the other value.
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
        const std::string now = present->of(key.name);
        const std::string group = about(key) + (now.empty() ? "" : ", now " + value_in_words(key.name, now));
        for (const std::string& value : few_values(key)) {
            if (value == now && is_flag(key)) continue;
            PaletteEntry entry = typed_exactly(model, sentence(key.name, '=', value), "", set_of);
            if (!entry.why_not.empty()) continue;
            entry.name = setting_in_words(key.name, value);
            entry.group = group;
            entries.push_back(std::move(entry));
        }
        if (has_more_values(key))
            entries.push_back({.name = title_of_setting(key.name), .group = group, .completion = key.name + '='});
    }
}

/// Words and a value behind them, as in "ambient 0.4".
struct WordsAndValue {
    std::string_view words, value;
};

/// Returns the entry of a setting with a typed value. If the value is refused, its name is the setting's, and the
/// reason says which values are expected.
PaletteEntry with_value(const Model& model, const SessionKey& key, std::string_view value)
{
    const bool is_on = is_flag(key) && lower_case(value) == "on", is_off = is_flag(key) && lower_case(value) == "off";
    const std::string text = sentence(key.name, '=', is_on ? "true" : is_off ? "false" : value);
    PaletteEntry entry = typed(model, text, "", set_of);
    const std::string title = title_of_setting(key.name);
    entry.group = about(key);
    entry.name = entry.why_not.empty() ? name_of(*entry.action) : title;
    if (entry.why_not.empty()) return entry;
    const size_t expected = entry.why_not.rfind("expected ");
    const std::string reason =
        expected == std::string::npos ? "expected another value" : entry.why_not.substr(expected);
    entry.why_not = title + ": " + (is_flag(key) ? "expected on or off" : reason);
    return entry;
}

/// Adds the settings that have the words, with the value. `refused` gets those that are called so and refuse the value.
void add_values(std::vector<PaletteEntry>& entries, std::vector<PaletteEntry>& refused, const Model& model,
                const WordsAndValue& wanted)
{
    size_t left = MAX_VALUES;
    for (const SessionKey& key : keys_of_settings()) {
        if (left == 0) return;
        if (!is_found(key, wanted.words)) continue;
        PaletteEntry entry = with_value(model, key, wanted.value);
        if (entry.why_not.empty()) {
            entries.push_back(std::move(entry));
            --left;
        } else if (has_words(called(key), wanted.words) && refused.size() < MAX_VALUES) {
            refused.push_back(std::move(entry));
        }
    }
}

/// The same for preferences that are numbers.
void add_preferred(std::vector<PaletteEntry>& entries, std::vector<PaletteEntry>& refused, const WordsAndValue& wanted)
{
    const std::optional<double> value = typed_number(wanted.value);
    for (const PreferenceNumber& number : PREFERENCE_NUMBERS) {
        if (!has_words(sentence(number.label, " preferences"), wanted.words)) continue;
        const std::string group = sentence("Preferences: ", number.hint);
        if (value && *value >= number.least && *value <= number.most) {
            const Action action = Prefer{sentence("{\"", number.key, "\":", digits_of(*value), '}')};
            entries.push_back({.name = name_of(action), .group = group, .action = action});
        } else {
            refused.push_back(
                {.name = number.label,
                 .group = group,
                 .why_not = sentence(number.label, ": expected a number from ", number_in_words(number.least), " to ",
                                     number_in_words(number.most), ' ', number.unit)});
        }
    }
}

/// Adds what the words and the value behind them set. Returns what would have been set by another value.
std::vector<PaletteEntry> add_by_value(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    std::vector<PaletteEntry> refused;
    const size_t space = text.rfind(' ');
    if (space == std::string_view::npos) return refused;
    const WordsAndValue wanted{trimmed(text.substr(0, space)), text.substr(space + 1)};
    if (model.is_open) add_values(entries, refused, model, wanted);
    add_preferred(entries, refused, wanted);
    return refused;
}

/// Adds actions found by the beginning of their id, and settings found by the beginning of their key.
void add_completions(std::vector<PaletteEntry>& entries, const std::string& text)
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

/// Returns the entries with what a key would be bound to, and with the keys of those that have some.
std::vector<PaletteEntry> bindable(std::vector<PaletteEntry> entries, const Model& model)
{
    for (PaletteEntry& entry : entries) {
        const Set* const set = entry.action ? entry.action->as<Set>() : nullptr;
        const bool changes_nothing = set && set->patch == "{}";
        if (!entry.action || !entry.bound_as.empty() || changes_nothing) continue;
        entry.bound_as = text_of(*entry.action);
        entry.keys = model.keymap.text_of_action(entry.bound_as);
    }
    return entries;
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
    std::vector<PaletteEntry> entries;
    add_typed(entries, model, text);
    const bool is_line = is_address(text) || text.find('=') != text.npos;
    if (is_line && !entries.empty()) return bindable(std::move(entries), model);
    // Only an action's id was typed, which may also be a word for something else: that comes first.
    const std::vector<PaletteEntry> as_typed = std::exchange(entries, {});
    add_shortcuts(entries, model, text);
    if (!text.empty()) {
        std::vector<PaletteEntry> refused = add_by_value(entries, model, text);
        add_listed(entries, model, text);
        if (model.is_open) add_settings(entries, model, text);
        if (entries.empty()) entries = std::move(refused);
    }
    const bool is_found = !entries.empty();
    for (const PaletteEntry& entry : as_typed)
        if (!is_found || entry.why_not.empty()) entries.push_back(entry);
    // A word of a person's may be the beginning of an id or a key, too.
    if (!is_found || text.find_first_of("_.") != text.npos) add_completions(entries, lower_case(text));
    return bindable(std::move(entries), model);
}

}  // namespace shvr::ui
