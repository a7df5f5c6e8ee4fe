#pragma once
// Messages about changed settings. Pure; any thread.

#include <string>

#include "engine/session/session.h"

namespace shvr::ui {

/// Returns a sentence about a change whose new value alone says too little; empty for other changes.
std::string special_sentence(const Session& was, const Session& is);

}  // namespace shvr::ui
