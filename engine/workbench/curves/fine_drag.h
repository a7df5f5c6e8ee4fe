#pragma once
// A drag that moves an item a tenth as far as the mouse while a modifier key is held. Pressing or releasing the
// modifier during the drag causes no jump. Pure; any thread.

#include <glm/glm.hpp>

namespace shvr::ui {

class FineDrag {
public:
    static constexpr float SHARE = 0.1f;

    FineDrag() = default;
    /// `mouse`: position where the drag begins. `held`: position of the dragged item, which may differ from `mouse`.
    FineDrag(const glm::vec2& mouse, const glm::vec2& held) : mouse_(mouse), held_(held) {}
    /// Returns the position of the item once the mouse is at `mouse`.
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
