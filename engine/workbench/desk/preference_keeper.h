#pragma once
// The user's preferences: keys, theme, layout and recently opened paths. A saver writes them to their file.

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

    /// Reads the file. If it is unreadable, it stays as it is, and nothing is written until it can be read.
    void load();
    /// Takes new preferences and saves them. If saving fails, the failure is reported and the preferences still apply.
    void prefer(Preferences preferences);
    /// Puts a path first in the list of recently opened paths.
    void note_opened(const std::filesystem::path& path);
    void await_no_key() { awaits_key_.clear(); }
    const Preferences& preferences() const { return preferences_; }
    const Keymap& keymap() const { return keymap_; }
    const std::string& awaits_key() const { return awaits_key_; }
    /// Returns the keys of a shortcut as displayed; empty if the shortcut has none.
    std::string keys_of(const char* shortcut) const;
    /// Returns text with the key of a shortcut, such as "; Ctrl + T sets that"; empty if the shortcut has no key.
    std::string with_key(const char* before, const char* shortcut, const char* after) const;
    PreferenceModel model() const;

private:
    Preferences preferences_;
    Keymap keymap_;
    std::string awaits_key_;  ///< id of the shortcut that the next key is bound to; empty: none
    bool are_kept_ = false;
};

}  // namespace shvr::ui
