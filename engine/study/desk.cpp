#include "engine/study/desk.h"

#include <algorithm>
#include <limits>

#include "engine/annotation/painting.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr uint8_t STUDY_GROUP = 1;

TouchMode mode_of(StudyTouch touch)
{
    switch (touch) {
        case StudyTouch::surface: return TouchMode::surface;
        case StudyTouch::object: return TouchMode::object;
        default: return TouchMode::proximity;
    }
}

}  // namespace

StudyDesk::StudyDesk(const StudyScene& scene, const StudyCondition& condition, const HandTraits& traits, uint32_t seed)
    : scene_(scene),
      touch_({.seed = seed}),
      relevance_([&scene](const RegionWish& wish, double, RelevancePatch& patch) { scene.put_relevance(wish, patch); },
                 WINDOW_LATENCY_S),
      growth_(std::make_unique<GrowthMemory>()),
      random_(seed),
      stray_(traits, random_),
      scale_(scene.voxels_per_metre()),
      work_(scene.size(), scene.volume().info().type)
{
    force_.assistance = condition.touch != StudyTouch::none;
    force_.mode = mode_of(condition.touch);
    force_.law = condition.law;
    force_.probe_radius = condition.probe_radii * scene.vein_radius();
    force_.workspace = {glm::dmat3(scale_), 0.5 * glm::dvec3(scene.size())};
}

void StudyDesk::place(const glm::dvec3& voxel)
{
    ++jump_;
    tick(voxel, 0.0);
}

const ForceStep& StudyDesk::tick(const glm::dvec3& aim, double speed, bool acts)
{
    seconds_ += STUDY_TICK_S;
    servo_ns_ += uint64_t(STUDY_TICK_S * 1e9);
    const glm::dvec3 wish = (aim - force_.workspace.origin) / scale_ + stray_.advance(STUDY_TICK_S, speed / scale_);
    touch_.wish().publish({.position_m = wish, .buttons = 0, .jump = jump_});
    const ReadResult read = touch_.read(state_);
    const glm::dvec3 probe = force_.workspace.to_point(state_.position_m);
    force_.finds_middle = acts;
    static const RelevancePatch NOTHING{};
    const RelevancePatch& patch =
        force_.assistance ? relevance_.around(step_.velocity, probe, force_, STUDY_THRESHOLD, servo_ns_) : NOTHING;
    step_ = shvr::step(force_, touch_.caps(), read, state_, patch, servo_ns_, memory_, *growth_);
    touch_.write(step_.force_n, step_.sequence);
    const double force_n = glm::length(step_.force_n);
    ++tally_.ticks;
    if (force_n > 0.0) {
        ++tally_.in_contact;
        tally_.force_sum_n += force_n;
        tally_.force_most_n = std::max(tally_.force_most_n, force_n);
    }
    return step_;
}

bool StudyDesk::edit_trace(const TraceOp& op)
{
    ++presses_;
    const TraceDefaults defaults{.radius_voxels = force_.probe_radius, .group = STUDY_GROUP, .size = scene_.size()};
    try {
        TraceEffect effect = effect_of(op, document().trace, defaults);
        if (!effect.changes.empty()) work_.perform({effect.label, as_changes(std::move(effect.changes))});
        if (effect.selection) work_.select_trace(std::move(*effect.selection));
        return true;
    } catch (const Error&) {
        return false;
    }
}

int64_t StudyDesk::paint(std::vector<glm::dvec3> path, double threshold)
{
    ++presses_;
    const PaintOp stroke{.brush = Brush::fill,
                         .group = STUDY_GROUP,
                         .threshold = threshold,
                         .radius_voxels = force_.probe_radius,
                         .path = std::move(path)};
    std::vector<MaskBrickChange> changes = paint_changes(document().mask, scene_.select(stroke), rule_of(stroke));
    if (changes.empty()) return 0;
    const int64_t before = document().mask.voxels_by_group()[STUDY_GROUP];
    work_.perform({"fill, group 1", as_changes(std::move(changes))});
    return document().mask.voxels_by_group()[STUDY_GROUP] - before;
}

void StudyDesk::undo()
{
    ++undos_;
    work_.undo();
}

void StudyDesk::put_outcomes(StudyRow& row) const
{
    const auto put = [&](Outcome outcome, double value) { row.values[size_t(outcome)] = value; };
    put(Outcome::seconds, std::min(seconds_, MAX_STUDY_S));
    put(Outcome::presses, presses_);
    put(Outcome::undos, undos_);
    put(Outcome::contact, tally_.ticks > 0 ? double(tally_.in_contact) / double(tally_.ticks) : 0.0);
    put(Outcome::energy, 1e3 * touch_.work_j());
    put(Outcome::force_most, tally_.force_most_n);
    put(Outcome::force_mean, tally_.in_contact > 0 ? tally_.force_sum_n / double(tally_.in_contact)
                                                   : std::numeric_limits<double>::quiet_NaN());
}

}  // namespace shvr
