#include "engine/workbench/words/touch_words.h"

#include <iterator>
#include <string_view>

namespace shvr::ui {

namespace {

/// Whether VALUE is a named enumerator: the compiler's name for a value without one is a cast, "(Type)3".
template <auto VALUE>
consteval bool is_named()
{
    return std::string_view(__PRETTY_FUNCTION__).find("VALUE = (") == std::string_view::npos;
}

/// Returns whether a table spells all values of its enumeration, in their order.
template <const auto& SPELLINGS>
consteval bool spells_all()
{
    using Value = decltype(SPELLINGS[0].value);
    constexpr size_t COUNT = std::size(SPELLINGS);
    for (size_t i = 0; i < COUNT; ++i)
        if (size_t(SPELLINGS[i].value) != i) return false;
    return is_named<Value(COUNT - 1)>() && !is_named<Value(COUNT)>();
}
static_assert(spells_all<TOUCH_MODES>() && spells_all<PROXY_LAWS>() && spells_all<TOUCH_PLANES>(),
              "the table next to the enumeration lacks a value");

}  // namespace

TouchWords words_of(TouchMode mode)
{
    switch (mode) {
        case TouchMode::proximity:
            return {"near", "Pulled to the middle of all that the probe touches: along roots and vessels.",
                    "Touching: pulled to the middle of all that is near"};
        case TouchMode::surface:
            return {"surface", "Held where the probe dips into something; pull towards yourself to get off.",
                    "Touching: held on surfaces, until you pull towards yourself"};
        case TouchMode::object:
            return {"object",
                    "Follows what is touched first and everything connected with it, past neighbours that it does not "
                    "touch.",
                    "Touching: follows the object first touched, and no neighbour"};
    }
    return {};
}

TouchWords words_of(ProxyLaw law)
{
    switch (law) {
        case ProxyLaw::potential:
            return {"smooth", "Grows from nothing at the first touch, and never drives the hand by itself.",
                    "Guidance: smooth"};
        case ProxyLaw::mean:
            return {"mean", "To the mean of what lies in the probe.", "Guidance: mean of what is relevant"};
        case ProxyLaw::thesis:
            return {"points", "To the mean of 3000 random points: rougher, as the first SHVR did it.",
                    "Guidance: mean of 3000 random points"};
    }
    return {};
}

TouchWords words_of(TouchPlane plane)
{
    switch (plane) {
        case TouchPlane::none: return {"free", "The probe goes wherever the hand does.", "The probe moves freely"};
        case TouchPlane::x: return {"x", "It stays in its plane across x.", "The probe stays in its plane across x"};
        case TouchPlane::y: return {"y", "It stays in its plane across y.", "The probe stays in its plane across y"};
        case TouchPlane::z: return {"z", "It stays in its plane across z.", "The probe stays in its plane across z"};
    }
    return {};
}

}  // namespace shvr::ui
