#include "engine/study/repeats.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/study/study_lines.h"

namespace shvr {

namespace {

constexpr std::string_view NAMES[] = {"task",
                                      "touch",
                                      "law",
                                      "probe_radii",
                                      "noise",
                                      "annotator",
                                      "other",
                                      "seed",
                                      "dice",
                                      "segment_agreement",
                                      "distance_rms_voxel"};

}  // namespace

std::string csv_of(std::span<const StudyRepeat> repeats)
{
    std::string csv = study_header(NAMES);
    for (const StudyRepeat& each : repeats) {
        const StudyCondition& c = each.condition;
        csv += sentence(spelled(c.task), ',', spelled(c.touch), ',', spelled(c.law), ',', digits_of(c.probe_radii), ',',
                        digits_of(c.noise), ',', each.annotator, ',', each.other, ',', each.seed);
        for (const double value : {each.dice, each.segment_agreement, each.distance_rms})
            csv += ',' + (std::isnan(value) ? std::string() : digits_of(value));
        csv += '\n';
    }
    return csv;
}

std::vector<StudyRepeat> read_study_repeats(const std::filesystem::path& file)
{
    std::vector<StudyRepeat> repeats;
    read_study_lines(file, NAMES, [&](const StudyLine& line) {
        repeats.push_back({.condition = line.condition(),
                           .annotator = line.whole(5),
                           .other = line.whole(6),
                           .seed = line.whole(7),
                           .dice = line.number_or_nan(8),
                           .segment_agreement = line.number_or_nan(9),
                           .distance_rms = line.number_or_nan(10)});
    });
    return repeats;
}

}  // namespace shvr
