#pragma once
// What differs between two sessions, as what a person did: phrases that begin with a past participle, for the history
// ("set ambient light from 0.2 to 0.3") and, with a capital letter, for the status bar. Any thread.

#include "engine/annotation/settings.h"
#include "engine/session/session.h"

namespace shvr {

/// Describes the differences of lasting or kept settings; empty if there are none.
std::string difference_of(const SettingValues& before, const SettingValues& after);
/// Describes the differences of all settings that a patch may change (session_patch.h).
std::string difference_in_words(const Session& before, const Session& after);

}  // namespace shvr
