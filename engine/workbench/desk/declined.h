#pragma once
// What a person asked for does not apply to what is there now. Nothing has failed: the window says it as it says what
// was done, and a script ends with it, as with any error. Any thread.

#include "engine/base/error.h"

namespace shvr::ui {

class Declined : public Error {
public:
    using Error::Error;
};

template <class... Parts>
[[noreturn]] void decline(const Parts&... parts)
{
    throw Declined(sentence(parts...));
}

}  // namespace shvr::ui
