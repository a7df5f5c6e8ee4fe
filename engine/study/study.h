#pragma once
// The study: the list of its annotations, and running them on several threads. All annotations of one phantom are one
// piece of work. Finished pieces are written at once, so that an interrupted study resumes. Rows are equal bit for bit
// for any number of threads, and however often the study was interrupted or split.

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
    size_t trait = SIZE_MAX;  ///< the member of hand_traits() that is multiplied by `factor`; SIZE_MAX: none
    double factor = 1.0;
};
/// Two annotations of one phantom, by one annotator twice or by two annotators.
struct StudyPair {
    StudyCondition condition;
    uint32_t annotator = 1, other = 1, seed = 1;
};

/// Overrides of a size's defaults, from `--conditions`, `--seeds` and `--annotators`.
struct StudyChoice {
    StudySize size = StudySize::standard;
    std::optional<uint32_t> seeds{};
    std::vector<StudyCondition> conditions{};  ///< empty: those of the size
    std::vector<uint32_t> annotators{};        ///< all of them annotate each phantom; empty: one each, in turn
};

struct StudyPlan {
    int64_t side = 256;                ///< side of the phantoms, voxels
    std::vector<uint32_t> annotators;  ///< as in StudyChoice, ascending
    std::vector<StudyItem> items;
    std::vector<StudyPair> pairs;
};
/// The central condition, from which one factor at a time is varied.
StudyCondition study_centre(StudyTask task);
/// Lists the conditions of painting and tracing. `standard`: 30 repeats of `none` and of the centre; 10 of each other
/// touch, law, probe radius and noise; 10 of `none` and of the centre with each hand trait halved and doubled; 10 pairs
/// for repeatability within and between annotators. `small`: a few of these, on small phantoms. `full`: 30 repeats of
/// all combinations. A varied probe radius or noise is compared with `none` at the same radius and noise.
StudyPlan plan_study(const StudyChoice& choice);
/// Reads conditions from a CSV file with the columns task, touch, law, probe_radii, noise. Fails with a message that
/// names file, line and column.
std::vector<StudyCondition> read_study_conditions(const std::filesystem::path& file);

struct StudyRun {
    std::filesystem::path folder;
    int threads = 0;           ///< 0: one for each core
    int64_t part = 0, of = 1;  ///< runs every `of`-th phantom, starting at number `part`
    /// Writes each trace and mask into the folder `annotations`. Annotations whose files are missing are made again.
    bool keeps_annotations = false;
    Progress progress{};  ///< may throw; the run then ends once the current phantoms are finished
};
struct StudyVariation {
    size_t trait = 0;
    double factor = 1.0;
    std::vector<StudyRow> rows;
};
/// Results in the order of the plan. A part, or an interrupted run, has only some of them.
struct StudyResults {
    std::vector<StudyRow> rows;
    std::vector<StudyVariation> variations;
    std::vector<StudyRepeat> repeats;
    size_t missing = 0;    ///< number of annotations and pairs that no run or part has made yet
    size_t made_here = 0;  ///< annotations that this run made
};
/// Runs the items that have no row yet. Writes rows*.csv, hand-TRAIT-FACTOR*.csv and repeats*.csv into the folder.
/// Fails if the folder holds a study with phantoms of another size.
StudyResults run_study(const StudyPlan& plan, const StudyRun& run);

}  // namespace shvr
