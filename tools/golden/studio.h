#pragma once
// Draws goldens, each on a new device, so that no picture depends on earlier pictures.
//
// One thread.

#include <optional>
#include <string>
#include <vector>

#include "engine/live/annotator.h"
#include "tools/golden/golden.h"

namespace shvr::golden {

/// Text by which the name of Mesa's lavapipe device is recognised.
inline constexpr std::string_view LAVAPIPE = "llvmpipe";

/// Sets environment variables for all goldens drawn later in this process. Makes lavapipe sample exactly, since its
/// fast 8-bit path is off by 1.6 levels, and selects lavapipe, unless the environment or `device` names another device.
void set_environment(const std::string& device = "");

struct StudioOptions {
    std::string device;  ///< as gpu::DeviceOptions::device
    bool validation = false;
    uint64_t budget_device = 0;  ///< bytes; 0: unlimited
};

class Studio {
public:
    /// Opens the session, loads volume and annotation, and paints. Fails if a line of the paint script paints nothing.
    explicit Studio(const Golden& golden, const StudioOptions& options = {});

    Renderer& renderer() { return renderer_; }
    const OpenedSession& opened() const { return opened_; }
    const Session& session() const { return opened_.session; }
    Camera camera() const;
    bool is_lavapipe();
    /// Loads the volume and paints again.
    void set_up();

    /// Draws a picture; may be called repeatedly. Fails if the picture is incomplete, or contains NaN or infinities.
    Image8 draw();
    Image8 draw(const Session& session, const Camera& camera);
    /// Counts as RenderOptions::count_work does, by pass.
    Picture draw_counted();
    Picture picture_of(const Session& session, const Camera& camera, bool counted);
    /// What is painted.
    const Document& document() const { return annotator_->document(); }
    /// Returns the validation messages since the last call. With `validation`, any such message is a failure.
    std::vector<std::string> take_validation_messages() { return renderer_.device().take_validation_messages(); }

private:
    const Golden golden_;
    OpenedSession opened_;
    Renderer renderer_;
    std::optional<Annotator> annotator_;
};

}  // namespace shvr::golden
