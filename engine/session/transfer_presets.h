#pragma once
// Transfer functions that fit any volume, from assets/transfer_functions (its README.md describes the files). Any
// thread.

#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

struct TransferPreset {
    std::string name, note;
    std::vector<ControlPoint> points;  ///< the `intensity` of a point is the fraction `at` in the preset's file
    bool extends = true;               ///< the last point's look extends to the volume's largest intensity
    bool is_own = false;               ///< made by the user, not shipped with the program
};

/// Returns all presets, sorted by name; none if the program finds no assets. Fails if a file is malformed.
std::vector<TransferPreset> transfer_presets();
/// Returns the user's own presets, from a folder that need not exist; leaves out malformed files, with the reason.
std::vector<TransferPreset> own_transfer_presets(const std::filesystem::path& folder,
                                                 std::vector<std::string>& warnings);
TransferPreset read_transfer_preset(const std::filesystem::path& file);
/// Returns the function as a preset that restores it, except for rounding, in the volume with these statistics.
TransferPreset preset_of(const TransferFunction& function, const std::string& name, const VolumeStatistics& statistics);
/// Returns the text of a preset in the form that `parse_transfer_preset` reads.
std::string text_of(const TransferPreset& preset);
/// Returns the path of the file of a preset name in a folder. Fails if the name is not valid for a file.
std::filesystem::path preset_file(const std::filesystem::path& folder, const std::string& name);
/// Returns the preset with this name; if there is none, fails with a list of the names.
TransferPreset transfer_preset_named(const std::string& name);
/// Parses a preset's text; `origin` names the text in messages.
TransferPreset parse_transfer_preset(const std::string& text, const std::string& name, const std::string& origin);

/// Returns the preset's function, scaled to the intensities of a volume.
TransferFunction transfer_function_of(const TransferPreset& preset, const VolumeStatistics& statistics);

}  // namespace shvr
