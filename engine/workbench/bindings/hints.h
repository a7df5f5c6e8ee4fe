#pragma once
// The three hints shown to users who open a scan for the first time. Pure; any thread.

#include <string>

#include "engine/workbench/bindings/keymap.h"

namespace shvr::ui {

inline constexpr int FIRST_HINTS = 3;
/// Returns hint `number` (0 ... FIRST_HINTS - 1), with the current keys.
std::string first_hint(int number, const Keymap& keymap);

/// Returns "Undo (Ctrl + Z)", or "Undo" if the shortcut has no key. `id`: a shortcut's id.
std::string name_with_key(const char* id, const Keymap& keymap);
/// Returns " (Ctrl + Z)", or an empty text if the shortcut has no key.
std::string key_in_brackets(const char* id, const Keymap& keymap);

}  // namespace shvr::ui
