#pragma once
// What people keep beside bare voxels, and what it says of them. For source_side_car.cpp, which knows where to look.
// Any thread may call these.

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

/// Our own: `document` describes the voxels of `raw`. Unknown keys are refused.
SideCar read_json_side_car(const JsonDocument& document, const std::filesystem::path& raw);

/// NSI's and Inviwo's text, or Dragonfly's XML. `raw` is empty where the side-car itself was opened, which then names
/// its voxels. Nothing where the file is about something else.
std::optional<SideCar> read_dat_side_car(const std::filesystem::path& path, std::filesystem::path raw);

/// "scan_512x512x300_16bit.raw". Nothing where the name holds no size.
std::optional<SideCar> read_file_name(const std::filesystem::path& raw);

}  // namespace shvr
