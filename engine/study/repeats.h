#pragma once
// Repeatability: pairs of annotations of the same phantom, by one annotator twice or by two. Any thread.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/study/rows.h"

namespace shvr {

struct StudyRepeat {
    StudyCondition condition;
    uint32_t annotator = 0, other = 0;  ///< equal: the same annotator twice
    uint32_t seed = 0;                  ///< seed of the phantom
    double dice;                        ///< Dice score of both masks; NaN for tracing
    double segment_agreement;           ///< segments found by both / by either; NaN for painting, or without any
    double distance_rms;                ///< root mean square distance between both traces, in voxels; NaN for painting
    bool is_within() const { return annotator == other; }
};

/// A CSV file (RFC 4180) with a header; NaN is an empty field.
std::string csv_of(std::span<const StudyRepeat> repeats);
/// Fails with a sentence that names file, line and column.
std::vector<StudyRepeat> read_study_repeats(const std::filesystem::path& file);

}  // namespace shvr
