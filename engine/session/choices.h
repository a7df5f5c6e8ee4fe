#pragma once
// What there is to choose from where a file holds several volumes and its settings name none. Any thread.

#include "engine/formats/choice.h"

namespace shvr {

/// Of an error of opening; empty: another reason.
inline std::vector<Choice> choices_of(const Error& error)
{
    const auto* const several = dynamic_cast<const ChoiceNeeded*>(&error);
    return several ? several->choices() : std::vector<Choice>();
}

}  // namespace shvr
