#include "engine/annotation/settings.h"

#include "engine/base/error.h"

namespace shvr {

std::string Settings::why_it_does_not_fit(const SettingChange& change, Direction) const
{
    return change.name.empty() ? "a setting has no name" : "";
}

void Settings::apply(const SettingChange& change, Direction direction)
{
    SHVR_CHECK(why_it_does_not_fit(change, direction).empty());
    const std::string& to = direction == Direction::forwards ? change.after : change.before;
    if (to.empty())
        values_.erase(change.name);
    else
        values_[change.name] = to;
}

}  // namespace shvr
