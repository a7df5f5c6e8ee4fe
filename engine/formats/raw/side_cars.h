#pragma once
// Side-cars: files kept beside raw voxels, and how they describe them. For source_side_car.cpp, which knows where to
// look. Any thread may call these.

#include <filesystem>
#include <optional>

#include "engine/base/json.h"
#include "engine/formats/raw/source_raw.h"

namespace shvr {

/// `info` lacks its name and format.
struct SideCar {
    VolumeInfo info{};
    RawVoxels voxels{};
};

/// Our own format: `document` describes the voxels of `raw`. Unknown keys are refused.
SideCar read_json_side_car(const JsonDocument& document, const std::filesystem::path& raw);

/// The text format of NSI and Inviwo, or Dragonfly's XML. `raw` is empty if the side-car itself was opened; it then
/// names its voxel file. Nothing if the file is about something else.
std::optional<SideCar> read_dat_side_car(const std::filesystem::path& path, std::filesystem::path raw);

/// "scan_512x512x300_16bit.raw". Nothing if the name contains no size.
std::optional<SideCar> read_file_name(const std::filesystem::path& raw);

}  // namespace shvr
