#pragma once
// Which handle the pointer takes hold of. Pure; any thread.

#include <algorithm>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr::ui {

/// Maximum distance between a handle and the pointer that takes hold of it, in pixels.
inline constexpr double HANDLE_PIXELS = 10.0;

/// Returns the handle at a pixel: of several, the nearest. `Handle` has `at`, in pixels of the same pane.
template <class Handle>
std::optional<Handle> handle_at(const std::vector<Handle>& handles, const glm::dvec2& pixel)
{
    const auto away = [&](const Handle& handle) { return glm::distance(handle.at, pixel); };
    const auto nearest = std::ranges::min_element(handles, {}, away);
    if (nearest == handles.end() || away(*nearest) > HANDLE_PIXELS) return std::nullopt;
    return *nearest;
}

}  // namespace shvr::ui
