#pragma once
// Changes of a session's settings as data: a JSON merge patch (RFC 7386), as in {"light": {"ambient": 0.4}}. In a
// patch, null resets a key to its default. Patches cover the sections transfer_function, groups, light, blend, cut,
// render, view, interaction and probe, but not volume, cameras, surfaces and files. Any thread.

#include <string>
#include <string_view>

#include "engine/session/session.h"

namespace shvr {

/// Returns the patch that changes `before` into `after`; empty if no setting differs. Colours are rounded to 8 bits.
std::string patch_between(const Session& before, const Session& after);
/// Returns the patch for a setting spelled as for --set: "light.ambient=0.4".
std::string patch_of(const std::string& setting);
/// Applies a merge patch to a JSON object. Fails if either text is no JSON object; messages call the patch `origin`.
std::string merged(std::string_view object, std::string_view patch, const std::string& origin);
/// Returns the session with the patch applied. Fails on unknown keys and on values out of range, with key, value and
/// expected values. A preset of a transfer function stays a name, for `transfer_function_of`.
Session patched(const Session& session, std::string_view patch);

}  // namespace shvr
