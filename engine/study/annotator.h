#pragma once
// Simulated annotators: each has its own hand, eye, pace and mistake rates, and annotates a scene under a condition,
// like a participant of the thesis's study. Parameter values were fixed before conditions were compared: by fitting ten
// annotators who use only object following to table 6.1 of the thesis (CALIBRATION.md).
//
// Equal inputs give equal rows, bit for bit. Any thread.

#include "engine/study/rows.h"
#include "engine/study/sight.h"

namespace shvr {

/// Factors of one annotator.
struct StudySkill {
    double unsteadiness = 1.0;  ///< scales wandering, swaying and errors of the eye
    double pace = 1.0;          ///< scales times between actions: above 1, slower
    double carelessness = 1.0;  ///< scales rates of mistakes and the share left unpainted
    double node_radii = 1.1;    ///< mean radius of the placed nodes / mean radius of the true nodes
};
inline constexpr uint32_t STUDY_ANNOTATORS = 10;
/// `annotator`: 1 to STUDY_ANNOTATORS.
StudySkill skill_of(uint32_t annotator);
HandTraits traits_of(const StudySkill& skill, const HandTraits& base = {});

/// Durations of everything except motion, in seconds.
struct StudyTimes {
    double key = 0.28;      ///< pressing a key or button (keystroke-level model: Card, Moran and Newell 1980)
    double mental = 1.35;   ///< a decision (likewise)
    double view = 4.0;      ///< changing the view: decide, hand to device and back, move (same model: M + 2 H + P)
    double travel = 1.5;    ///< moving to another part of the section, with the force paused
    double node = 6.4;      ///< finding the next place before each node; calibrated: segments in ten minutes
    double stroke = 2.5;    ///< pausing before a stroke; calibrated: times of painting in the thesis, section 6.2
    double patience = 2.0;  ///< a tool acts after this time even if the hand has not settled; a guess
};

/// The mistakes observed in the thesis's study (section 6.2, figure 6.6). Rates are per segment, and ours.
enum class Mistake : uint8_t {
    stops_early,        ///< painting ends before the bundle does
    receptacle,         ///< paints receptacle tissue; only at segments of florets
    leaves_gaps,        ///< does not check the stroke, so parts stay unpainted, such as its back
    adaxial_unpainted,  ///< for adaxial segments
    wrong_bundle,       ///< paints one that is not joined to adaxial veins: the task is misunderstood
    joins_bundles,      ///< two separate bundles joined
    joins_distant,      ///< two distant nodes joined
    joins_within,       ///< joins two nodes of one bundle, bypassing the nodes between them
};
inline constexpr size_t MISTAKES = 8;
struct MistakeRate {
    Mistake mistake;
    std::string_view name;
    double rate;
};
std::span<const MistakeRate> mistake_rates();
/// Share of mistakes that the annotator notices and undoes; a guess.
inline constexpr double NOTICED = 0.5;

struct MistakeTally {
    std::array<uint32_t, MISTAKES> chances{}, made{}, undone{};
};

struct StudyAnnotation {
    StudyRow row;
    MistakeTally mistakes;
    uint32_t views_changed = 0, segments_unseen = 0;
    TraceGraph trace;
    Mask mask{Size3(0)};
};
/// `base`: traits before the annotator's own factors are applied. `attempt`: selects random numbers; several attempts
/// of one annotator differ only by chance.
StudyAnnotation annotate(const StudyScene& scene, const StudyCondition& condition, uint32_t annotator, uint32_t seed,
                         const HandTraits& base = {}, uint32_t attempt = 0);

}  // namespace shvr
