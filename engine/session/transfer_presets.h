#pragma once
// Transfer functions that fit any volume, from assets/transfer_functions (its README.md describes the files). Any
// thread.

#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

struct TransferPreset {
    std::string name, note;
    std::vector<ControlPoint> points;  ///< `intensity` is the share `at` of the file
};

/// All presets, by name; none if the program finds no assets. Fails if a file is broken.
std::vector<TransferPreset> transfer_presets();
/// Fails with a list of the names if there is no such preset.
TransferPreset transfer_preset_named(const std::string& name);
/// A preset's text; `origin` names it in messages.
TransferPreset parse_transfer_preset(const std::string& text, const std::string& name, const std::string& origin);

/// The preset, scaled to the intensities of a volume.
TransferFunction transfer_function_of(const TransferPreset& preset, const VolumeStatistics& statistics);

}  // namespace shvr
