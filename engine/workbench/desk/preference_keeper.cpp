#include "engine/workbench/desk/preference_keeper.h"

#include <algorithm>

#include "engine/base/text.h"
#include "engine/workbench/bindings/preferences_file.h"

namespace shvr::ui {

namespace {

/// Sets the keys of a shortcut or an action. Keys equal to the default are not stored, so that they follow if the user
/// later chooses the other set of keys.
void set_keys(Preferences& preferences, const std::string& id, const std::vector<Chord>& chords)
{
    preferences.unusable_keys.erase(id);
    const Shortcut* const shortcut = shortcut_named(id);
    const bool is_as_shipped = shortcut ? chords == Keymap(preferences.key_set).chords_of(*shortcut) : chords.empty();
    preferences.keys.erase(id);
    if (is_as_shipped) return;
    std::vector<std::string>& texts = preferences.keys[id];
    for (const Chord& chord : chords) texts.push_back(text_of(chord));
}

/// Returns the ids of what has one of the chords, other than `id`.
std::vector<std::string> other_holders(const Keymap& keymap, const std::vector<Chord>& chords, const std::string& id)
{
    std::vector<std::string> others;
    for (const Chord& chord : chords)
        for (std::string& holder : keymap.holders_of(chord))
            if (holder != id && std::ranges::find(others, holder) == others.end()) others.push_back(std::move(holder));
    return others;
}

/// "'Save' and 'Undo'"
std::string names_of(const std::vector<std::string>& ids)
{
    std::string names;
    for (const std::string& id : ids) names += sentence(names.empty() ? "" : " and ", '\'', name_of_binding(id), '\'');
    return names;
}

}  // namespace

void PreferenceKeeper::act(const ChooseKeys& action)
{
    Preferences preferences = preferences_;
    const auto set = std::ranges::find(KEY_SETS, action.set, &Spelling<KeySet>::name);
    if (set == std::end(KEY_SETS)) fail("keys: '", action.set, "' is no set; expected modern or thesis");
    preferences.key_set = set->value;
    prefer(std::move(preferences));
    say(set->value == KeySet::modern ? "Keys: the default set" : "Keys: the set of the SHVR thesis");
    for (const std::string& conflict : keymap_.conflicts()) say(conflict, Weight::warning);
}

void PreferenceKeeper::act(const BindKeys& action)
{
    const std::string name = name_of_binding(action.shortcut);  // fails for what is no shortcut and no action
    std::vector<std::string> texts;
    for (const std::string_view chord : words_of(action.keys)) texts.emplace_back(chord);
    const std::vector<Chord> chords = chords_of(action.shortcut, texts);
    const std::vector<std::string> losers = other_holders(keymap_, chords, action.shortcut);
    const bool is_pressed = awaits_key_ == action.shortcut;
    if (!losers.empty() && is_pressed && asked_keys_ != action.keys) {
        asked_keys_ = action.keys;
        key_question_ = sentence("The key ", in_words(chords.front()), " stands for ", names_of(losers),
                                 "; press it again to give it to '", name, "', or Escape to leave it");
        return say(key_question_, Weight::warning);
    }
    Preferences preferences = preferences_;
    for (const std::string& loser : losers) {
        std::vector<Chord> left = keymap_.chords_of(loser);
        std::erase_if(left, [&](const Chord& each) { return std::ranges::find(chords, each) != chords.end(); });
        set_keys(preferences, loser, left);
    }
    set_keys(preferences, action.shortcut, chords);
    prefer(std::move(preferences));
    await_no_key();
    if (chords.empty()) return say(sentence("'", name, "' has no key"));
    say(sentence("The key ", in_words(chords.front()), " stands for '", name, "'",
                 losers.empty() ? std::string() : ", no longer for " + names_of(losers)));
    for (const std::string& conflict : keymap_.conflicts()) say(conflict, Weight::warning);
}

void PreferenceKeeper::act(const AwaitKey& action)
{
    if (action.shortcut.empty()) return await_no_key();
    const std::string name = name_of_binding(action.shortcut);  // fails for what is no shortcut and no action
    await_no_key();
    awaits_key_ = action.shortcut;
    say(sentence("Press the key for '", name, "'; Escape keeps its key, Delete removes it"));
}

void PreferenceKeeper::await_no_key()
{
    awaits_key_.clear();
    asked_keys_.clear();
    key_question_.clear();
}

void PreferenceKeeper::act(const Prefer& action)
{
    prefer(patched(preferences_, action.patch));
}

void PreferenceKeeper::act(const ForgetRecent& action)
{
    Preferences preferences = preferences_;
    std::erase(preferences.recent, action.path);
    prefer(std::move(preferences));
}

/// Reads the file. If that fails, the file stays as it is, and preferences are not saved until it can be read.
void PreferenceKeeper::load()
{
    if (options_.settings.empty() || !options_.has_preferences) return;
    try {
        std::vector<std::string> complaints;
        preferences_ = ui::load_preferences(preferences_file(options_.settings), &complaints);
        keymap_ = Keymap(preferences_.key_set, preferences_.keys);
        are_kept_ = true;
        for (const std::string& complaint : complaints) say(complaint, Weight::warning);
    } catch (const Error& error) {
        say(sentence(error.what(), "; the default keys are used, and the file is unchanged"), Weight::warning);
    }
    for (const std::string& conflict : keymap_.conflicts()) say(conflict, Weight::warning);
}

/// Applies new preferences and saves them. If saving fails, the failure is reported, but the preferences still apply.
void PreferenceKeeper::prefer(Preferences preferences)
{
    if (preferences == preferences_) return;
    keymap_ = Keymap(preferences.key_set, preferences.keys);
    preferences_ = std::move(preferences);
    if (!are_kept_) return;
    savers_.start("keeping preferences",
                  [file = preferences_file(options_.settings), kept = preferences_](ProgressReporter&) {
                      save_preferences(file, kept);
                      return Jobs::Completion();
                  });
}

void PreferenceKeeper::note_opened(const std::filesystem::path& path)
{
    Preferences next = preferences_;
    next.note_opened(path);
    prefer(std::move(next));
}

std::string PreferenceKeeper::keys_of(const char* shortcut) const
{
    const Shortcut* const found = shortcut_named(shortcut);
    SHVR_CHECK(found, shortcut);
    return keymap_.text_of(*found);
}

std::string PreferenceKeeper::with_key(const char* before, const char* shortcut, const char* after) const
{
    const std::string keys = keys_of(shortcut);
    return keys.empty() ? keys : before + keys + after;
}

PreferenceModel PreferenceKeeper::model() const
{
    return {.keymap = keymap_, .preferences = preferences_, .awaits_key = awaits_key_, .key_question = key_question_};
}

}  // namespace shvr::ui
