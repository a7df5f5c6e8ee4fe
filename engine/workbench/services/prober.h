#pragma once
// Position and size of the probe.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Prober : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<Pane(size_t index)> pane;
        Call<std::optional<glm::dvec3>(const Pane&, const glm::dvec2& pixel)> seen_at;
        Call<std::optional<glm::dvec3>(const Pane&, const glm::dvec2& pixel, double depth, double reach)> seen_near;
        Call<void()> extend_stroke;
        Call<void()> note_edit;
        Call<void()> note_to_keep;
    };
    Prober(Desk& desk, Others others);
    void act(const ProbeTo& action);
    void act(const ProbeOnto& action);
    void act(const ProbeAlong& action);
    void act(const PushProbe& action);
    void act(const PlaceProbe& action);
    void act(const ScaleProbe& action);

    /// Moves the probe. A stroke in progress extends to the new position.
    /// `hovers`: slices stay where they are; otherwise they follow.
    void move_probe(const glm::dvec3& point, bool jumps, bool hovers = false);
    ProbeModel model() const;

private:
    void lift();
    void hold_slices(bool hovers);
    void lead_probe(const glm::dvec3& point, bool jumps);

    const Others others_;
};

}  // namespace shvr::ui
