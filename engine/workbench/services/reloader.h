#pragma once
// Settings that load the volume once more (render.sampling, render.paging): in slices next to the scene that is shown,
// which stays in use until the next stands. Where the device has no room for both, the document is put away for the
// time, as for opening.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Opener;
class Photographer;
struct Services;
class SettingsEditor;
class Viewer;

class Reloader : public Service {
public:
    /// No job has this number.
    static constexpr Jobs::Number NUMBER = Jobs::Number{1} << 49;

    explicit Reloader(Services& all);
    ~Reloader() override;

    void advance() override;
    bool advances_without_document() const override { return true; }
    /// Where the volume cannot be loaded with the session's settings, that is said at once. `before`: as they were.
    void want(const RenderSettings& before);
    bool is_wanted() const { return reload_ != nullptr; }
    /// Returns whether there was one.
    bool cancel();
    /// The volume is loaded as its settings now say, by other means.
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
    std::shared_ptr<Reload> reload_;  ///< null: what is shown is as the settings say
};

}  // namespace shvr::ui
