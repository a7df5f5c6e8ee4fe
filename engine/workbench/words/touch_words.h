#pragma once
// Names, hints and messages for the modes of touch, the laws of guidance, and the planes that hold the probe. Pure; any
// thread.

#include "engine/session/session.h"

namespace shvr::ui {

struct TouchWords {
    const char* name = "";      ///< on a button
    const char* hint = "";      ///< what the choice does
    const char* sentence = "";  ///< message in the status bar after the user has chosen the value
};
TouchWords words_of(TouchMode mode);
TouchWords words_of(ProxyLaw law);
TouchWords words_of(TouchPlane plane);

}  // namespace shvr::ui
