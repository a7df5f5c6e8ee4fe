#pragma once
// Three hints for who opens a scan for the first time. Pure; any thread.

#include <string>

#include "engine/workbench/bindings/keymap.h"

namespace shvr::ui {

inline constexpr int FIRST_HINTS = 3;
/// Number 0 ... FIRST_HINTS - 1, with the keys as they are now.
std::string first_hint(int number, const Keymap& keymap);

/// "Undo (Ctrl + Z)", or "Undo" where it has no key; the id of a shortcut.
std::string name_with_key(const char* id, const Keymap& keymap);
/// " (Ctrl + Z)", or nothing.
std::string key_in_brackets(const char* id, const Keymap& keymap);

}  // namespace shvr::ui
