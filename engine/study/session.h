#pragma once
// The base of an annotator's tracing and painting sessions. The annotator chooses a view, reaches for a place as the
// eye locates it, holds until the probe looks right or feels steady, and acts. One thread.

#include <memory>

#include "engine/study/annotator.h"
#include "engine/study/desk.h"
#include "engine/study/plan.h"

namespace shvr {

struct StudySessionInput {
    const StudyScene& scene;
    StudyCondition condition;
    StudySkill skill;
    HandTraits traits;
    uint32_t seed = 1;
};

class StudySession {
public:
    explicit StudySession(const StudySessionInput& input);
    virtual ~StudySession() = default;
    virtual void run() = 0;

    const StudyDesk& desk() const { return desk_; }
    const MistakeTally& mistakes() const { return mistakes_; }
    uint32_t views_changed() const { return views_changed_; }
    uint32_t segments_unseen() const { return segments_unseen_; }

protected:
    const StudyScene& scene() const { return input_.scene; }
    const StudyView& view() const { return study_views()[view_]; }
    /// Changes to a view that shows most of the places, if necessary. Returns the share of places that are visible.
    double look_at(std::span<const glm::dvec3> voxels, double radius);
    void change_view(size_t view);
    /// Moves the hand to a place as the eye locates it: one reach, then a visual correction. The force is paused during
    /// a long reach.
    void reach(const glm::dvec3& seen);
    /// Holds the hand until the probe looks right or feels steady. Afterwards a tool may act at `desk().tool()`.
    void settle(const glm::dvec3& seen);
    /// Where a place is taken to be.
    glm::dvec3 seen(const glm::dvec3& voxel) { return voxel + sight_.error_of_glance(view(), random_); }
    /// Moves the place that the hand aims at along a straight line, with minimum jerk.
    void move(const glm::dvec3& to, double seconds);
    void think(double seconds) { desk_.spend(seconds * input_.skill.pace); }
    /// Decides at random whether a mistake happens now, and counts the opportunity.
    bool errs(Mistake mistake);
    /// Decides at random whether the annotator notices the mistake just made. If so, undoes the last `steps` commands.
    void notice(Mistake mistake, size_t steps);

    StudySessionInput input_;
    StudyTimes times_;
    StudyRandom random_;
    StudyDesk desk_;
    StudySight sight_;
    glm::dvec3 aim_{0.0};  ///< in voxels: where the hand would be if it did not stray
    size_t view_ = 0;
    uint32_t views_changed_ = 0, segments_unseen_ = 0;
    MistakeTally mistakes_;
};

std::unique_ptr<StudySession> make_tracing_session(const StudySessionInput& input);
std::unique_ptr<StudySession> make_painting_session(const StudySessionInput& input);

/// Share of a segment's places that must be visible in some view; otherwise the segment is skipped.
inline constexpr double SEEN_ENOUGH = 0.5;

}  // namespace shvr
