#pragma once
// Repetition that the everyday run leaves to preset dev-slow. Each sentence is proved in both; a slow run repeats the
// proof for more seeds, sizes, budgets and combinations.

#include <cstdlib>
#include <string_view>

namespace shvr::test {

/// Preset dev-slow sets SHVR_SLOW=1.
inline bool is_slow()
{
    const char* const chosen = std::getenv("SHVR_SLOW");
    return chosen != nullptr && std::string_view(chosen) == "1";
}

/// Chooses a number of repetitions, or the list of what is repeated.
template <class T>
T repeats(T everyday, T slow)
{
    return is_slow() ? slow : everyday;
}

}  // namespace shvr::test
