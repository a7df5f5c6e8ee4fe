#pragma once
// The available choices when a file holds several volumes and its settings select none. Any thread.

#include "engine/formats/choice.h"

namespace shvr {

/// Returns the choices that an opening error carries; empty if the error has another reason.
inline std::vector<Choice> choices_of(const Error& error)
{
    const auto* const several = dynamic_cast<const ChoiceNeeded*>(&error);
    return several ? several->choices() : std::vector<Choice>();
}

}  // namespace shvr
