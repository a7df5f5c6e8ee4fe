#pragma once
// The study: which annotations it consists of, and running them on several threads. Annotations of one phantom form a
// piece of work; finished pieces are written at once, so a study that was interrupted continues where it was. Rows are
// equal bit for bit at any number of threads, and however often the study was interrupted or split.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/study/annotator.h"
#include "engine/study/repeats.h"

namespace shvr {

enum class StudySize : uint8_t { small, standard, full };
inline constexpr Spelling<StudySize> STUDY_SIZES[] = {
    {StudySize::small, "small"}, {StudySize::standard, "standard"}, {StudySize::full, "full"}};
constexpr std::span<const Spelling<StudySize>> spellings_of(StudySize)
{
    return STUDY_SIZES;
}

/// One annotation.
struct StudyItem {
    StudyCondition condition;
    uint32_t annotator = 1, seed = 1;
    size_t trait = SIZE_MAX;  ///< of hand_traits(), multiplied by `factor`; SIZE_MAX: none
    double factor = 1.0;
};
/// Two annotations of one phantom, by one annotator twice or by two.
struct StudyPair {
    StudyCondition condition;
    uint32_t annotator = 1, other = 1, seed = 1;
};

/// What `--conditions`, `--seeds` and `--annotators` choose instead of a size's own.
struct StudyChoice {
    StudySize size = StudySize::standard;
    std::optional<uint32_t> seeds{};
    std::vector<StudyCondition> conditions{};  ///< empty: those of the size
    std::vector<uint32_t> annotators{};        ///< each annotates each phantom; empty: one for each, in turn
};

struct StudyPlan {
    int64_t side = 256;                ///< side of the phantoms, voxels
    std::vector<uint32_t> annotators;  ///< as in StudyChoice, ascending
    std::vector<StudyItem> items;
    std::vector<StudyPair> pairs;
};
/// The condition around which one factor at a time is varied.
StudyCondition study_centre(StudyTask task);
/// Lists the conditions of painting and tracing. `standard`: 30 repeats of `none` and of the centre; 10 of each other
/// touch, law, probe radius and noise; 10 of `none` and of the centre with each trait of the hand halved and doubled;
/// 10 pairs for repeatability within and between annotators. `small`: a few of these, on small phantoms. `full`: 30
/// repeats of all combinations. A varied probe radius or noise is compared with `none` at the same radius and noise.
StudyPlan plan_study(const StudyChoice& choice);
/// Reads conditions: a CSV file with the columns task, touch, law, probe_radii, noise. Fails with a sentence that names
/// file, line and column.
std::vector<StudyCondition> read_study_conditions(const std::filesystem::path& file);

struct StudyRun {
    std::filesystem::path folder;
    int threads = 0;           ///< 0: one for each core
    int64_t part = 0, of = 1;  ///< runs every `of`-th phantom, from number `part` on
    /// Writes each trace and each mask into the folder `annotations`; those that are missing there are made again.
    bool keeps_annotations = false;
    Progress progress{};  ///< may throw, which ends the run after the phantoms in work
};
struct StudyVariation {
    size_t trait = 0;
    double factor = 1.0;
    std::vector<StudyRow> rows;
};
/// In the order of the plan. A part, or an interrupted run, has fewer.
struct StudyResults {
    std::vector<StudyRow> rows;
    std::vector<StudyVariation> variations;
    std::vector<StudyRepeat> repeats;
    size_t missing = 0;    ///< annotations, and pairs of them, that no part has made yet
    size_t made_here = 0;  ///< annotations that this run made
};
/// Writes rows*.csv, hand-TRAIT-FACTOR*.csv and repeats*.csv into the folder, and reads those that are there. Fails if
/// the folder holds a study of another size of phantoms.
StudyResults run_study(const StudyPlan& plan, const StudyRun& run);

}  // namespace shvr
