#include "engine/study/repeats.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

std::string csv_of(std::span<const StudyRepeat> repeats)
{
    std::string csv =
        "task,touch,law,probe_radii,noise,annotator,other,seed,dice,segment_agreement,distance_rms_voxel\n";
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

}  // namespace shvr
