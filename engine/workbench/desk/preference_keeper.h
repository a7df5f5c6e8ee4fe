#pragma once
// The user's preferences: keys, theme, layout and recently opened paths. A saver thread writes them to their file.

#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/desk/service.h"
#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

class PreferenceKeeper : public Service {
public:
    explicit PreferenceKeeper(Desk& desk) : Service(desk) {}
    void act(const ChooseKeys& action);
    void act(const BindKeys& action);
    void act(const AwaitKey& action);
    void act(const Prefer& action);
    void act(const ForgetRecent& action);

    /// Reads the file. If that fails, the file stays as it is, and preferences are not saved until it can be read.
    void load();
    /// Applies new preferences and saves them. If saving fails, this is reported, but the preferences still apply.
    void prefer(Preferences preferences);
    /// Moves or inserts a path at the front of the list of recently opened paths.
    void note_opened(const std::filesystem::path& path);
    void await_no_key();
    const Preferences& preferences() const { return preferences_; }
    const Keymap& keymap() const { return keymap_; }
    const std::string& awaits_key() const { return awaits_key_; }
    /// Returns the keys of a shortcut as displayed; empty if the shortcut has none.
    std::string keys_of(const char* shortcut) const;
    /// Returns text around the key of a shortcut, such as "; Ctrl + T sets that"; empty if the shortcut has no key.
    std::string with_key(const char* before, const char* shortcut, const char* after) const;
    PreferenceModel model() const;

private:
    Preferences preferences_;
    Keymap keymap_;
    std::string awaits_key_;    ///< id of the shortcut, or the action as text, that gets the next key; empty: none
    std::string asked_keys_;    ///< keys that stand for something else: pressed again, they are taken over
    std::string key_question_;  ///< what was asked then
    bool are_kept_ = false;
};

}  // namespace shvr::ui
