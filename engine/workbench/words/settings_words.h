#pragma once
// Messages about changed settings. Pure; any thread.

#include <string>

#include "engine/session/session.h"

namespace shvr::ui {

/// Returns a sentence about a change of settings that needs more words than the new value; empty for other changes.
std::string special_sentence(const Session& was, const Session& is);

}  // namespace shvr::ui
