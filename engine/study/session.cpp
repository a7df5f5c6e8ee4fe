#include "engine/study/session.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace shvr {

namespace {

constexpr double FAR_M = 0.010;           ///< longer reaches pause the force, as navigation did (thesis 6.2)
constexpr double ENGAGE_S = 1.0;          ///< time until a paused force is fully back (haptics/force.h)
constexpr double MIN_REACH_S = 0.25;      ///< minimum duration of a reach (Meyer et al. 1988)
constexpr double RIGHT_S = 0.1;           ///< time for which the probe must look right before a tool acts
constexpr double STEADY_M_PER_S = 0.003;  ///< below this speed, a guided hand feels steady
constexpr double TOLERANCE = 1.5;         ///< in standard deviations of the eye: smaller errors look right
constexpr double WRONG_BUNDLE = 2.0;      ///< in vein radii: a guided probe farther off is on another bundle

}  // namespace

StudySession::StudySession(const StudySessionInput& input)
    : input_(input),
      random_(input.seed * uint64_t{7919} + 17),
      desk_(input.scene, input.condition, input.traits, input.seed),
      sight_(input.scene, input.traits),
      aim_(0.5 * glm::dvec3(input.scene.size()))
{
    desk_.look_from(view().to_eye);
    desk_.place(aim_);
}

void StudySession::change_view(size_t view)
{
    if (view == view_) return;
    view_ = view;
    ++views_changed_;
    desk_.look_from(this->view().to_eye);
    think(times_.view);
}

double StudySession::look_at(std::span<const glm::dvec3> voxels, double radius)
{
    if (sight_.visible_share(view(), voxels, radius) < 0.9) change_view(sight_.best_view(view_, voxels, radius));
    return sight_.visible_share(view(), voxels, radius);
}

void StudySession::move(const glm::dvec3& to, double seconds)
{
    const glm::dvec3 from = aim_;
    const int ticks = std::max(int(std::lround(seconds / STUDY_TICK_S)), 1);
    for (int i = 1; i <= ticks && !desk_.is_over(); ++i) {
        const glm::dvec3 next = glm::mix(from, to, share_of_way(double(i) / ticks));
        desk_.tick(next, glm::distance(next, aim_) / STUDY_TICK_S);
        aim_ = next;
    }
}

void StudySession::reach(const glm::dvec3& seen)
{
    const double scale = scene().voxels_per_metre();
    const double away = glm::distance(aim_, seen);
    const glm::dvec3 first = glm::mix(aim_, seen, 1.0 + input_.traits.overshoot * random_.normal());
    if (away > FAR_M * scale) {
        think(times_.travel);
        aim_ = first;
        desk_.place(first);
        if (input_.condition.touch != StudyTouch::none) move(first, ENGAGE_S);
    } else {
        move(first, std::max(away / (input_.traits.speed_m_per_s * scale), MIN_REACH_S));
    }
    move(aim_, input_.traits.lag_s);
    move(seen, MIN_REACH_S);
}

void StudySession::settle(const glm::dvec3& seen)
{
    const double scale = scene().voxels_per_metre();
    const double lateral = TOLERANCE * input_.traits.lateral_m * scale,
                 deep = TOLERANCE * input_.traits.depth_m * scale;
    const size_t lag = size_t(std::max(input_.traits.lag_s / STUDY_TICK_S, 1.0));
    std::deque<glm::dvec3> shown;
    double right_s = 0.0, steady_s = 0.0;
    for (double held_s = 0.0; held_s < times_.patience && !desk_.is_over(); held_s += STUDY_TICK_S) {
        const ForceStep& step = desk_.tick(aim_, 0.0);
        shown.push_back(step.probe);
        if (shown.size() <= lag) continue;
        const glm::dvec3 off = shown.front() - seen;
        shown.pop_front();
        const double along = std::abs(glm::dot(off, view().to_eye));
        const double across = glm::length(off - glm::dot(off, view().to_eye) * view().to_eye);
        const bool looks_right = across <= lateral && along <= deep;
        const bool is_there = across <= WRONG_BUNDLE * scene().vein_radius();
        const bool is_steady = desk_.feels() && is_there && glm::length(step.velocity) < STEADY_M_PER_S * scale;
        right_s = looks_right ? right_s + STUDY_TICK_S : 0.0;
        steady_s = is_steady ? steady_s + STUDY_TICK_S : 0.0;
        if (right_s >= RIGHT_S || steady_s >= input_.traits.lag_s) break;
    }
    desk_.tick(aim_, 0.0, true);
}

bool StudySession::errs(Mistake mistake)
{
    const auto i = size_t(mistake);
    ++mistakes_.chances[i];
    const bool happens = random_.happens(mistake_rates()[i].rate * input_.skill.carelessness);
    mistakes_.made[i] += happens;
    return happens;
}

void StudySession::notice(Mistake mistake, size_t steps)
{
    if (!random_.happens(NOTICED)) return;
    ++mistakes_.undone[size_t(mistake)];
    think(times_.mental);
    for (size_t i = 0; i < steps; ++i) {
        desk_.undo();
        desk_.spend(times_.key);
    }
}

}  // namespace shvr
