#pragma once
// Reloads the volume after changes of render.sampling or render.paging: in slices, next to the displayed scene,
// which stays in use until the new one is complete. If the device has no room for both, the document is put away for
// that time, as for opening.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Opener;
class Photographer;
struct Services;
class SettingsEditor;
class Viewer;

class Reloader : public Service {
public:
    /// Number of the reload among the jobs: no job has it.
    static constexpr Jobs::Number NUMBER = Jobs::Number{1} << 49;

    explicit Reloader(Services& all);
    ~Reloader() override;

    void advance() override;
    bool advances_without_document() const override { return true; }
    /// Starts a reload. Reports at once if the session's settings cannot be loaded. `before`: the previous ones.
    void want(const RenderSettings& before);
    bool is_wanted() const { return reload_ != nullptr; }
    /// Cancels the reload. Returns whether there was one.
    bool cancel();
    /// Drops the reload: the volume was loaded with the current settings by other means.
    void forget() { reload_.reset(); }
    Jobs::State state() const;

private:
    struct Reload;
    void begin();
    void drop_queries();

    Opener& opener_;
    Photographer& photographer_;
    SettingsEditor& settings_;
    Viewer& viewer_;
    std::shared_ptr<Reload> reload_;  ///< null: the displayed scene matches the settings
};

}  // namespace shvr::ui
