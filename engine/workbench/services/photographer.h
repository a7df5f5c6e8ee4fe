#pragma once
// Screenshots of the view: as shown, or larger and rendered in the background.

#include "engine/workbench/desk/service.h"
#include "engine/workbench/document/screenshots.h"

namespace shvr::ui {

class Photographer : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<glm::uvec2()> pixels;  ///< size of the displayed picture
    };
    Photographer(Desk& desk, Others others);
    void act(const Screenshot& action);

    void advance() override;
    bool has_large() const { return screenshots_.has_large(); }
    bool is_writing() const { return screenshots_.is_writing(); }
    void wait() const { screenshots_.wait(); }
    /// Cancels the large screenshot, if there is one, and reports `by` as the cause.
    void drop_large(const char* by);
    /// Cancels the large screenshot, and reports so, if its job number is `number`. Returns whether it has that number.
    bool cancel(Jobs::Number number);
    /// Adds the state of the large screenshot, if there is one.
    void add_loading(std::vector<Jobs::State>& states) const;
    /// Returns the base of names for files next to the session: "scan" for scan-view-1.png.
    std::filesystem::path stem() const;
    /// Sets the number of pixels per unit of the interface, for drawing over pictures.
    void set_units(double units) { units_ = units; }
    /// Sets whether the device is idle; large screenshots continue only then.
    void set_still(bool is_still) { is_still_ = is_still; }

private:
    void follow_screenshots();
    Figure figure_of_picture(uint32_t scale) const;
    Screenshots::Texts texts_of_picture(const glm::uvec2& pixels, bool shows_probe) const;

    const Others others_;
    Screenshots screenshots_;
    double units_ = 1.0;
    bool is_still_ = true;
    Attempt photographing_;
};

}  // namespace shvr::ui
