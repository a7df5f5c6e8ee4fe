#pragma once
// How touch pulls the probe. The session stores these choices and haptics implements them. Neither of these folders may
// include the other, so both include this file.

#include <cstdint>

#include "engine/base/spelling.h"

namespace shvr {

/// Selects what pulls the probe (haptics/modes.h).
enum class TouchMode : uint8_t {
    proximity,  ///< pulls towards the mean of all relevant voxels in the ball
    surface,    ///< holds the probe where enough of the ball is relevant, until the probe moves towards the camera
    object,     ///< like proximity, restricted to the object that was touched first
};
inline constexpr Spelling<TouchMode> TOUCH_MODES[] = {
    {TouchMode::proximity, "proximity"}, {TouchMode::surface, "surface"}, {TouchMode::object, "object"}};
constexpr std::span<const Spelling<TouchMode>> spellings_of(TouchMode)
{
    return TOUCH_MODES;
}

/// Selects how the proxy is computed from the relevant voxels in the ball (haptics/proxy.h).
enum class ProxyLaw : uint8_t { potential, mean, thesis };
inline constexpr Spelling<ProxyLaw> PROXY_LAWS[] = {
    {ProxyLaw::potential, "potential"}, {ProxyLaw::mean, "mean"}, {ProxyLaw::thesis, "thesis"}};
constexpr std::span<const Spelling<ProxyLaw>> spellings_of(ProxyLaw)
{
    return PROXY_LAWS;
}

}  // namespace shvr
