#pragma once
// A mouse drag during which an item moves a tenth as far as the mouse while a modifier key is held. Pressing or
// releasing the modifier causes no jump. Pure; any thread.

#include <glm/glm.hpp>

namespace shvr::ui {

class FineDrag {
public:
    static constexpr float SHARE = 0.1f;

    FineDrag() = default;
    /// `mouse`: where the mouse is when the drag begins. `held`: position of the dragged item, which may be elsewhere.
    FineDrag(const glm::vec2& mouse, const glm::vec2& held) : mouse_(mouse), held_(held) {}
    /// Returns the new position of the item, given the mouse position; `is_fine`: whether the modifier is held.
    glm::vec2 follow(const glm::vec2& mouse, bool is_fine)
    {
        held_ += (is_fine ? SHARE : 1.0f) * (mouse - mouse_);
        mouse_ = mouse;
        return held_;
    }

private:
    glm::vec2 mouse_{0.0f}, held_{0.0f};
};

}  // namespace shvr::ui
