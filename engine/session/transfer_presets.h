#pragma once
// Transfer functions that fit any volume, from assets/transfer_functions (its README.md describes the files). Any thread.

#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

struct TransferPreset {
    std::string name, note;
    std::vector<ControlPoint> points;  ///< `intensity` is the share `at` of the file
};

/// All there are, by name; none where the program finds no assets. Fails where a file is broken.
std::vector<TransferPreset> transfer_presets();
/// Fails with the names that there are where it is none of them.
TransferPreset transfer_preset_named(const std::string& name);
/// A preset's text; `origin` names it in messages.
TransferPreset parse_transfer_preset(const std::string& text, const std::string& name, const std::string& origin);

/// Laid over the intensities of a volume.
TransferFunction transfer_function_of(const TransferPreset& preset, const VolumeStatistics& statistics);

}  // namespace shvr
