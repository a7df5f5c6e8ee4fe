#pragma once
// Changes of a session's settings as data: a JSON merge patch (RFC 7386), as in {"light": {"ambient": 0.4}}; null gives
// a key its default again. The settings are the sections transfer_function, groups, light, blend, cut, render, view,
// interaction and probe; volume, cameras, surfaces and files are not. Any thread.

#include <string>
#include <string_view>

#include "engine/session/session.h"

namespace shvr {

/// The patch that makes `before` into `after`; empty where no setting differs. Colours are rounded to 8 bits.
std::string patch_between(const Session& before, const Session& after);
/// The patch of a setting as --set takes it, "light.ambient=0.4".
std::string patch_of(const std::string& setting);
/// A merge patch applied to any JSON object. Fails where one of them is none; `origin` names the patch in messages.
std::string merged(std::string_view object, std::string_view patch, const std::string& origin);
/// The session with the patch applied. Fails at unknown keys and at values out of range, naming key, value and what was
/// expected. A transfer preset is left for `transfer_function_of`.
Session patched(const Session& session, std::string_view patch);
/// What differs, in words: "light: ambient 0.2 to 0.3", "groups: 3 color" or "transfer function".
std::string difference_in_words(const Session& before, const Session& after);

}  // namespace shvr
