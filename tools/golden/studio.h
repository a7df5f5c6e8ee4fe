#pragma once
// Draws goldens, each on a device of its own, so that no picture depends on earlier ones.
//
// One thread.

#include <optional>
#include <string>
#include <vector>

#include "engine/live/annotator.h"
#include "tools/golden/golden.h"

namespace shvr::golden {

/// Part of the name of Mesa's lavapipe device.
inline constexpr std::string_view LAVAPIPE = "llvmpipe";

/// Sets the environment for all goldens drawn later in this process. Makes lavapipe sample exactly (its fast 8-bit path
/// is off by 1.6 levels), and selects it as the device, unless the environment or `device` states another.
void set_environment(const std::string& device = "");

struct StudioOptions {
    std::string device;  ///< as gpu::DeviceOptions::device
    bool validation = false;
    uint64_t budget_device = 0;  ///< bytes; 0: unlimited
};

class Studio {
public:
    /// Opens the session, loads its volume and annotation, and paints. Fails if a line of the script paints nothing.
    explicit Studio(const Golden& golden, const StudioOptions& options = {});

    Renderer& renderer() { return renderer_; }
    const OpenedSession& opened() const { return opened_; }
    const Session& session() const { return opened_.session; }
    Camera camera() const;
    bool is_lavapipe();
    /// Loads the volume and paints again.
    void set_up();

    /// May be called repeatedly. Fails if the picture is incomplete, or contains NaN or infinities.
    Image8 draw();
    Image8 draw(const Session& session, const Camera& camera);
    /// Counts as RenderOptions::count_work does, by pass.
    Picture draw_counted();
    Picture picture_of(const Session& session, const Camera& camera, bool counted);
    /// What is painted.
    const Document& document() const { return annotator_->document(); }
    /// Returns the messages since the last call; with `validation`, any message is a failure.
    std::vector<std::string> take_validation_messages() { return renderer_.device().take_validation_messages(); }

private:
    const Golden golden_;
    OpenedSession opened_;
    Renderer renderer_;
    std::optional<Annotator> annotator_;
};

}  // namespace shvr::golden
