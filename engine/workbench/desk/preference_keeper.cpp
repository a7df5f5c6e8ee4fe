#include "engine/workbench/desk/preference_keeper.h"

#include <algorithm>

#include "engine/base/text.h"
#include "engine/workbench/bindings/preferences_file.h"

namespace shvr::ui {

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
    const Shortcut* const shortcut = shortcut_named(action.shortcut);
    Preferences preferences = preferences_;
    std::vector<std::string>& keys_of_it = preferences.keys[action.shortcut];
    keys_of_it.clear();
    preferences.unusable_keys.erase(action.shortcut);
    for (const std::string_view chord : words_of(action.keys)) keys_of_it.emplace_back(chord);
    // A binding equal to the default is not stored, so that it follows if the user later chooses the other set of keys.
    const Keymap changed(preferences.key_set, preferences.keys);  // fails for what is no shortcut and no action
    const bool is_as_shipped = shortcut
                                   ? changed.chords_of(*shortcut) == Keymap(preferences.key_set).chords_of(*shortcut)
                                   : keys_of_it.empty();
    if (is_as_shipped) preferences.keys.erase(action.shortcut);
    prefer(std::move(preferences));
    awaits_key_.clear();
    const std::string keys = shortcut ? keymap_.text_of(*shortcut) : keymap_.text_of_action(action.shortcut);
    const std::string name = shortcut ? shortcut->name : action.shortcut;
    say(keys.empty() ? sentence("'", name, "' has no key") : sentence("The key ", keys, " stands for ", name));
    for (const std::string& conflict : keymap_.conflicts()) say(conflict, Weight::warning);
}

void PreferenceKeeper::act(const AwaitKey& action)
{
    const Shortcut* const shortcut = shortcut_named(action.shortcut);
    if (!action.shortcut.empty() && !shortcut) static_cast<void>(Keymap(KeySet::modern, {{action.shortcut, {}}}));
    awaits_key_ = action.shortcut;
    if (!action.shortcut.empty())
        say(sentence("Press the key for '", shortcut ? shortcut->name : action.shortcut,
                     "'; Escape keeps its key, Delete removes it"));
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
    return {.keymap = keymap_, .preferences = preferences_, .awaits_key = awaits_key_};
}

}  // namespace shvr::ui
