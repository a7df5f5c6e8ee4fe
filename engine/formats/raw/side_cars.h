#pragma once
// Readers of side-cars: files next to raw voxels that describe them. For source_side_car.cpp, which finds the files.
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

/// Reads our own format; `document` describes the voxels of `raw`. Fails for unknown keys.
SideCar read_json_side_car(const JsonDocument& document, const std::filesystem::path& raw);

/// Reads the text format of NSI and Inviwo, or Dragonfly's XML. `raw` is empty if the user opened the side-car itself,
/// which then names its voxel file. Null if the file has another format.
std::optional<SideCar> read_dat_side_car(const std::filesystem::path& path, std::filesystem::path raw);

/// Whether a file name is that of a CT scanner's header: .vgi (VGStudio), .xtekct (Nikon) or .vol.info (PyHST).
bool is_scanner_header(const std::filesystem::path& path);
/// Reads a CT scanner's header. `raw` is empty if the user opened the header itself. Fails if the header is damaged.
SideCar read_scanner_header(const std::filesystem::path& path, std::filesystem::path raw);
/// Finds and reads the CT scanner's header next to the voxels in `raw`; null if there is none.
std::optional<SideCar> find_scanner_header(const std::filesystem::path& raw);

/// Parses a file name such as "scan_512x512x300_16bit.raw". Returns null if the name contains no size.
std::optional<SideCar> read_file_name(const std::filesystem::path& raw);

}  // namespace shvr
