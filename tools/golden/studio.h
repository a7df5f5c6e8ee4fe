#pragma once
// Draws goldens, each with a device of its own, so that no picture depends on the ones before.
//
// One thread.

#include <optional>
#include <string>
#include <vector>

#include "engine/live/annotator.h"
#include "tools/golden/golden.h"

namespace shvr::golden {

/// Part of the name by which Mesa's lavapipe calls its device.
inline constexpr std::string_view LAVAPIPE = "llvmpipe";

/// The environment of every golden, for all that are drawn later in this process: exact sampling in lavapipe (its fast
/// 8-bit path is off by 1.6 levels) and its device, unless the environment or `device` says otherwise.
void set_environment(const std::string& device = "");

struct StudioOptions {
    std::string device;  ///< as gpu::DeviceOptions::device
    bool validation = false;
    uint64_t budget_device = 0;  ///< bytes; 0: as much as there is
};

class Studio {
public:
    /// Opens the session, loads its volume and annotation, and paints. Fails where a line of the script paints nothing.
    explicit Studio(const Golden& golden, const StudioOptions& options = {});

    Renderer& renderer() { return renderer_; }
    const OpenedSession& opened() const { return opened_; }
    const Session& session() const { return opened_.session; }
    Camera camera() const;
    bool is_lavapipe();
    /// Loads the volume and paints anew.
    void set_up();

    /// Any number of times. Fails where the picture is incomplete or holds a value that is no number.
    Image8 draw();
    Image8 draw(const Session& session, const Camera& camera);
    /// As RenderOptions::count_work counts them, by pass.
    Picture draw_counted();
    Picture picture_of(const Session& session, const Camera& camera, bool counted);
    /// What is painted.
    const Document& document() const { return annotator_->document(); }
    /// Since the last call; with `validation` any is a failure.
    std::vector<std::string> take_validation_messages() { return renderer_.device().take_validation_messages(); }

private:
    const Golden golden_;
    OpenedSession opened_;
    Renderer renderer_;
    std::optional<Annotator> annotator_;
};

}  // namespace shvr::golden
