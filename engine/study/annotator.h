#pragma once
// Simulated annotators: each has a hand, an eye, a pace and a rate of mistakes, and annotates a scene under a condition
// as the participants of the thesis's study did. Values are fixed by comparing ten annotators with table 6.1 of the
// thesis, with object following alone, before any conditions are compared (CALIBRATION.md).
//
// Equal inputs give equal rows, bit for bit. Any thread.

#include "engine/study/rows.h"
#include "engine/study/sight.h"

namespace shvr {

/// Factors of one annotator.
struct StudySkill {
    double unsteadiness = 1.0;  ///< of wandering, swaying and errors of the eye
    double pace = 1.0;          ///< of times between actions: above 1, slower
    double carelessness = 1.0;  ///< of rates of mistakes, and of what is left unpainted
    double node_radii = 1.1;    ///< radius of the nodes that are placed / mean radius of the true nodes
};
inline constexpr uint32_t STUDY_ANNOTATORS = 10;
/// `annotator`: 1 to STUDY_ANNOTATORS.
StudySkill skill_of(uint32_t annotator);
HandTraits traits_of(const StudySkill& skill, const HandTraits& base = {});

/// What costs time apart from motion, in seconds.
struct StudyTimes {
    double key = 0.28;      ///< a key or button (keystroke-level model: Card, Moran and Newell 1980)
    double mental = 1.35;   ///< a decision (likewise)
    double view = 4.0;      ///< another view: a decision, hand to the device and back, a motion (likewise: M + 2 H + P)
    double travel = 1.5;    ///< to another part of the section, with the force paused
    double node = 6.4;      ///< before a node: finding where to go on. Calibrated: segments traced in ten minutes
    double stroke = 2.5;    ///< before a stroke. Calibrated: times of painting in the thesis, section 6.2
    double patience = 2.0;  ///< until a hand that does not settle acts anyway; a guess
};

/// Rates of the mistakes that were seen in the study (thesis, figure 6.6 and 6.2): for each segment, unless stated.
enum class Mistake : uint8_t {
    stops_early,        ///< painting ends before the bundle does
    receptacle,         ///< receptacle tissue painted; for segments of florets
    leaves_gaps,        ///< the stroke is not looked at: parts stay unpainted
    adaxial_unpainted,  ///< for adaxial segments
    wrong_bundle,       ///< a bundle painted that is not joined to adaxial veins
    joins_bundles,      ///< two separate bundles joined
    joins_distant,      ///< two distant nodes joined
    joins_within,       ///< two nodes of one bundle joined, past those between them
};
inline constexpr size_t MISTAKES = 8;
struct MistakeRate {
    Mistake mistake;
    std::string_view name;
    double rate;
};
std::span<const MistakeRate> mistake_rates();
/// Share of mistakes that their maker notices, and undoes; a guess.
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
/// `base`: traits before the factors of the annotator.
/// `attempt`: another one by the same annotator differs by chance alone.
StudyAnnotation annotate(const StudyScene& scene, const StudyCondition& condition, uint32_t annotator, uint32_t seed,
                         const HandTraits& base = {}, uint32_t attempt = 0);

}  // namespace shvr
