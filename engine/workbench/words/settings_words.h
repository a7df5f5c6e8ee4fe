#pragma once
// What is said of changed settings. Pure; any thread.

#include <string>

#include "engine/session/session.h"

namespace shvr::ui {

/// A sentence about a change for which there is more to say than what was set; empty for others.
std::string special_sentence(const Session& was, const Session& is);

}  // namespace shvr::ui
