#pragma once
// Takes screenshots: of the view as shown, or larger ones, which are rendered in the background as figures and movies
// are.

#include "engine/workbench/desk/service.h"
#include "engine/workbench/document/project_pictures.h"
#include "engine/workbench/document/screenshots.h"
#include "engine/workbench/sight/figure_elements.h"

namespace shvr::ui {

class Photographer : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<glm::uvec2()> pixels;  ///< size of the displayed picture
        Call<void()> stay_open;     ///< takes back the wish to close the window, if that waits for a picture
    };
    Photographer(Desk& desk, Others others);
    void act(const Screenshot& action);
    void act(const FigureTask& task);
    void act(const MovieTask& task);

    void advance() override;
    bool has_large() const { return screenshots_.has_large(); }
    bool is_writing() const { return screenshots_.is_writing(); }
    void wait() const { screenshots_.wait(); }
    /// Cancels the large screenshot in progress, if any, with a message that names `by` as the cause.
    void drop_large(const char* by);
    /// If the large screenshot in progress has the job number `number`, cancels the screenshot and returns true.
    bool cancel(Jobs::Number number);
    /// Adds the state of the large screenshot in progress, if any.
    void add_loading(std::vector<Jobs::State>& states) const;
    /// Returns the start of the names of files next to the session, such as "scan" in scan-view-1.png.
    std::filesystem::path stem() const;
    /// Sets the number of pixels per unit of the interface, for drawing over pictures.
    void set_units(double units) { units_ = units; }
    /// Sets whether the device is idle. Large screenshots make progress only while it is.
    void set_still(bool is_still) { is_still_ = is_still; }

private:
    /// Says that a picture is drawn in the background; what is said of its progress takes the place of that.
    void say_begun(std::string text, Weight weight = Weight::done);
    void follow_screenshots();
    void follow_project_picture();
    glm::uvec2 pixels_of(const glm::ivec2& asked) const;
    Session session_of_pictures(const glm::uvec2& pixels) const;
    Figure drawn_elements(const DrawnElements& elements, const Session& session, const Camera& camera,
                          std::vector<std::string>& left_out, FigureMemory* memory = nullptr) const;
    std::filesystem::path project_of_pictures() const;
    void draw_with(const Groups& groups, const std::function<void()>& draw) const;
    Figure figure_of_picture(uint32_t scale) const;
    Screenshots::Texts texts_of_picture(const glm::uvec2& pixels, bool shows_probe) const;

    const Others others_;
    Screenshots screenshots_;
    ProjectPictures project_pictures_;
    double units_ = 1.0;
    bool is_still_ = true;
    uint64_t progress_message_ = 0;  ///< number of the message that tells the progress of a picture; 0: none yet
    Attempt photographing_;
};

}  // namespace shvr::ui
