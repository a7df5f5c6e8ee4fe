#pragma once
// Screenshots: as shown, or larger, drawn in the background.

#include "engine/workbench/desk/service.h"
#include "engine/workbench/document/screenshots.h"

namespace shvr::ui {

struct Services;
class Viewer;

class Photographer : public Service {
public:
    /// Number of the large screenshot among the jobs: no job has it.
    static constexpr Jobs::Number NUMBER = (Jobs::Number{1} << 49) + 1;

    explicit Photographer(Services& all);
    void act(const Screenshot& action);

    void advance() override;
    bool has_large() const { return screenshots_.has_large(); }
    bool is_writing() const { return screenshots_.is_writing(); }
    void wait() const { screenshots_.wait(); }
    /// Cancels the large screenshot, if there is one, and reports the cause.
    void drop_large(const char* by);
    /// Cancels it silently.
    void drop_large() { screenshots_.drop_large(); }
    Jobs::State state_of_large() const;
    /// Returns the base of names for files next to the session: "scan" for scan-view-1.png.
    std::filesystem::path stem() const;
    /// Sets the pixels per unit of the interface, for drawing over pictures.
    void set_units(double units) { units_ = units; }
    /// Sets whether the device is idle: then large screenshots may continue.
    void set_still(bool is_still) { is_still_ = is_still; }

private:
    void follow_screenshots();
    Figure figure_of_picture(uint32_t scale) const;
    Screenshots::Texts texts_of_picture(const glm::uvec2& pixels, bool shows_probe) const;

    Viewer& viewer_;
    Screenshots screenshots_;
    double units_ = 1.0;
    bool is_still_ = true;
    Attempt photographing_;
};

}  // namespace shvr::ui
