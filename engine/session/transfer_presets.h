#pragma once
// Transfer functions that can be scaled to any volume, from assets/transfer_functions (see its README.md for the
// files). Any thread.

#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

struct TransferPreset {
    std::string name, note;
    std::vector<ControlPoint> points;  ///< here `intensity` is the fraction `at` of the preset's file
    bool extends = true;               ///< whether the last point's look extends up to the largest intensity
    bool is_own = false;               ///< made by the user; false: part of the program
};

/// Returns all presets of the program, sorted by name; none if assets are not found. Fails if a file is malformed.
std::vector<TransferPreset> transfer_presets();
/// Returns the user's presets, from a folder that need not exist. Leaves out malformed files, and returns the reasons.
std::vector<TransferPreset> own_transfer_presets(const std::filesystem::path& folder,
                                                 std::vector<std::string>& warnings);
TransferPreset read_transfer_preset(const std::filesystem::path& file);
/// Returns a preset from which transfer_function_of() restores the function for this volume, except for rounding.
TransferPreset preset_of(const TransferFunction& function, const std::string& name, const VolumeStatistics& statistics);
/// Returns the JSON of a preset, which `parse_transfer_preset` reads.
std::string text_of(const TransferPreset& preset);
/// Returns why a name cannot be that of a kept transfer function or look (`kind`), whose file it names; empty: it can.
std::string why_no_name(const std::string& name, const char* kind);
/// Returns the path of a preset's file in a folder. Fails if the name cannot be a file name.
std::filesystem::path preset_file(const std::filesystem::path& folder, const std::string& name);
/// Returns the preset with this name. Fails with a list of the names if there is none.
TransferPreset transfer_preset_named(const std::string& name);
/// Parses the JSON of a preset. Messages call the text `origin`.
TransferPreset parse_transfer_preset(const std::string& text, const std::string& name, const std::string& origin);

/// Returns the function of a preset, scaled to the intensities of a volume.
TransferFunction transfer_function_of(const TransferPreset& preset, const VolumeStatistics& statistics);

}  // namespace shvr
