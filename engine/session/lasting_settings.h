#pragma once
// What of a session is a person's work and undone like paint: the transfer function, groups, light, blending, cuts,
// measured distances, background, saturation and smooth borders. Cameras, panes and the probe are not
// (kept_settings.h). Any thread.

#include "engine/annotation/settings.h"
#include "engine/session/session.h"

namespace shvr {

/// The JSON of each section, as a session file holds it: colours are rounded to the 8 bits of their spelling. "picture"
/// holds those keys of a file's `render` that say how the picture looks, whatever makes it.
SettingValues lasting_settings(const Session& session);
/// Sets the sections of `values`; others stay. Fails, changing nothing, where one cannot be read.
void set_lasting_settings(Session& session, const SettingValues& values);
/// `values` as this version of the program writes them. Fails like set_lasting_settings.
SettingValues normalized_settings(const SettingValues& values);
/// `values`, lasting or kept ones, but for the sections that these "key=value" settings set.
SettingValues without_overridden(SettingValues values, const std::vector<std::string>& settings);
/// Copies what "picture" is about.
void take_picture(RenderSettings& to, const RenderSettings& from);
/// What differs, in words: "light: ambient 0.2 to 0.3", "groups: 3 color" or "transfer function".
std::string difference_of(const SettingValues& before, const SettingValues& after);

}  // namespace shvr
