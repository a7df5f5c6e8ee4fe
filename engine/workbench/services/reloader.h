#pragma once
// Reloads the volume after changes of render.sampling or render.paging:
//
//   worker      coarser levels, if bricks will be paged and the volume has none
//   main        loads the volume onto the device in slices          -> Scene
//   main        replaces the scene
//
// Until the last step the old scene stays on display, and failures and cancellation restore its settings. If the device
// has no room for both scenes and the document, the document is unloaded until the new scene is loaded, as when another
// document is opened.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Reloader : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<bool()> is_opening;
        Call<std::string_view()> opening_name;
        Call<void()> load_alone;          ///< unloads the document, then loads it again
        Call<bool()> is_drawing_picture;  ///< a large one, or a movie
        Call<void(const char* by)> drop_screenshot;
        Call<void()> note_edit;
        Call<void()> look_again;
    };
    Reloader(Desk& desk, Others others);
    ~Reloader() override;

    void advance() override;
    bool advances_without_document() const override { return true; }
    /// Requests a reload. Fails if the volume is too large for the session's settings, or a movie is being drawn.
    /// `before`: the earlier settings.
    void want(const RenderSettings& before);
    bool is_wanted() const { return reload_ != nullptr; }
    /// Cancels the reload. Returns whether there was one.
    bool cancel();
    /// If the reload has the job number `number`, cancels the reload and returns true.
    bool cancel(Jobs::Number number);
    /// If a finished job is the reading job of the reload, handles the job and returns true.
    bool end_reading(const Jobs::Finished& job);
    /// Adds the state of the reload, if there is one and its reading job is not running.
    void add_loading(std::vector<Jobs::State>& states) const;

private:
    struct Reload;
    std::string title() const;
    void read();
    void begin();
    void load_alone();
    void show();
    void drop_queries();
    void restore_settings();
    void give_up(const std::string& why);

    const Others others_;
    std::shared_ptr<Reload> reload_;  ///< null: the scene on display matches the settings
};

}  // namespace shvr::ui
