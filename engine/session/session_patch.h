#pragma once
// Changes of a session's settings as data: a JSON merge patch (RFC 7386), as in {"light": {"ambient": 0.4}}, where null
// resets a key to its default. Patches cover the sections transfer_function, groups, light, blend, cut, render, view,
// interaction and probe, but not volume, cameras, surfaces and files. Any thread.

#include <string>
#include <string_view>

#include "engine/session/session.h"

namespace shvr {

/// Returns the patch that turns `before` into `after`; empty if no setting differs. Colours are rounded to 8 bits.
std::string patch_between(const Session& before, const Session& after);
/// Returns the patch for a setting in the form of --set, "light.ambient=0.4".
std::string patch_of(const std::string& setting);
/// Applies a merge patch to any JSON object. Fails if either is not an object; `origin` names the patch in messages.
std::string merged(std::string_view object, std::string_view patch, const std::string& origin);
/// Returns the session with the patch applied. Fails on unknown keys and on values out of range; the message has the
/// key, the value and the expected values. Leaves a transfer preset for `transfer_function_of`.
Session patched(const Session& session, std::string_view patch);
/// Describes the differences: "light: ambient 0.2 to 0.3", "groups: 3 color" or "transfer function".
std::string difference_in_words(const Session& before, const Session& after);

}  // namespace shvr
