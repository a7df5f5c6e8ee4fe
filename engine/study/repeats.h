#pragma once
// Repeatability: compares pairs of annotations of one phantom, by one annotator twice or by two annotators. Any thread.

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
    double dice;                        ///< Dice score of one mask against the other; NaN for tracing
    double segment_agreement;           ///< segments found by both / by either; NaN for painting or if none is found
    double distance_rms;                ///< root mean square distance between both traces, voxels; NaN for painting
    bool is_within() const { return annotator == other; }
};

/// Returns a CSV file (RFC 4180) with a header. NaN becomes an empty field.
std::string csv_of(std::span<const StudyRepeat> repeats);
/// Reads the file that `csv_of` writes. Fails with a message that names file, line and column.
std::vector<StudyRepeat> read_study_repeats(const std::filesystem::path& file);

}  // namespace shvr
