#pragma once
// Position and size of the probe.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Painter;
struct Services;
class SettingsEditor;
class Viewer;

class Prober : public Service {
public:
    explicit Prober(Services& all);
    void act(const ProbeTo& action);
    void act(const ProbeOnto& action);
    void act(const ProbeAlong& action);
    void act(const PushProbe& action);
    void act(const PlaceProbe& action);
    void act(const ScaleProbe& action);

    /// Moves the probe, and extends the open stroke.
    void move_probe(const glm::dvec3& point, bool jumps);
    ProbeModel model() const;

private:
    void lift();

    Viewer& viewer_;
    Painter& painter_;
    SettingsEditor& settings_;
};

}  // namespace shvr::ui
