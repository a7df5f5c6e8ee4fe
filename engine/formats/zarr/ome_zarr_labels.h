#pragma once
// Reads the label descriptions of an OME-Zarr label image (https://ngff.openmicroscopy.org/0.5/#labels-md; same in
// 0.4): "image-label" with "colors" [{"label-value", "rgba"}] and "properties" [{"label-value", "name", ...}]. Any
// thread may call these functions.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shvr {

struct LabelLook {
    int64_t value = 0;
    std::optional<std::array<uint8_t, 4>> rgba{};  ///< sRGB, and alpha
    std::string name{};                            ///< may be empty
};
struct LabelLooks {
    std::vector<LabelLook> looks{};       ///< sorted by label; if a label occurs twice, its first entry counts
    std::vector<std::string> warnings{};  ///< at most one per list, about the list's first invalid entry
};

/// Whether the folder, or the path into an archive, holds a label image. False if that cannot be read.
bool is_ome_zarr_label(const std::filesystem::path& folder);
/// Empty if the folder, or the path into an archive, is no label image. Fails if its attributes are not JSON.
LabelLooks read_label_looks(const std::filesystem::path& folder);
/// Returns the lines of an NRRD header that this program stores in a label image's attribute "shvr"; often none.
std::vector<std::string> read_label_header(const std::filesystem::path& folder);

}  // namespace shvr
