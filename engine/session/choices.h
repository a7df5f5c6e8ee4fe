#pragma once
// The choices to offer if a file holds several volumes and the settings select none of them. Any thread.

#include "engine/formats/choice.h"

namespace shvr {

/// Returns the choices that the error lists; empty if the error has another reason.
inline std::vector<Choice> choices_of(const Error& error)
{
    const auto* const several = dynamic_cast<const ChoiceNeeded*>(&error);
    return several ? several->choices() : std::vector<Choice>();
}

}  // namespace shvr
