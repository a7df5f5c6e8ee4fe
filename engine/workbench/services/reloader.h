#pragma once
// Reloads the volume after changes of render.sampling or render.paging. The new scene is loaded in slices; the
// displayed scene stays in use until the new one is complete. If the device has no room for both, the document is
// unloaded while the new scene loads, as for opening.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Reloader : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<bool()> is_opening;
        Call<std::string_view()> opening_name;
        Call<void()> load_alone;  ///< unloads the document and loads it again
        Call<void(const char* by)> drop_screenshot;
        Call<void()> note_edit;
        Call<void()> look_again;
    };
    Reloader(Desk& desk, Others others);
    ~Reloader() override;

    void advance() override;
    bool advances_without_document() const override { return true; }
    /// Starts a reload. Reports at once if the session's settings cannot be loaded. `before`: the previous settings.
    void want(const RenderSettings& before);
    bool is_wanted() const { return reload_ != nullptr; }
    /// Cancels the reload. Returns whether there was one.
    bool cancel();
    /// Cancels the reload, and reports so, if its job number is `number`. Returns whether it has that number.
    bool cancel(Jobs::Number number);
    /// Drops the reload, since another operation has already loaded the volume with the current settings.
    void forget() { reload_.reset(); }
    /// Adds the state of the reload, if there is one.
    void add_loading(std::vector<Jobs::State>& states) const;

private:
    struct Reload;
    void begin();
    void drop_queries();

    const Others others_;
    std::shared_ptr<Reload> reload_;  ///< null: the displayed scene matches the settings
};

}  // namespace shvr::ui
