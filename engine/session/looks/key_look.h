#pragma once
// Looks that are kept with views, for movies: what the window showed when a view was kept. Pure; any thread.

#include <string>

#include "engine/session/session.h"

namespace shvr {

/// Returns what the session itself shows.
KeyLook key_look_of(const Session& session);
/// Returns the look that was kept with a view, or if there is none, what the session itself shows. Names and locks of
/// groups are no part of a look: they are those of the session.
KeyLook key_look_of(const Session& session, const std::string& view);
/// Returns the session with this look; unchanged if none was kept with the view.
Session with_key_look(Session session, const std::string& view);

}  // namespace shvr
