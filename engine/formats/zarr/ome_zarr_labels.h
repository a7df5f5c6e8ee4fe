#pragma once
// What an OME-Zarr label image says of its labels (https://ngff.openmicroscopy.org/0.4/#label-md): "image-label" with
// "colors" [{"label-value", "rgba"}] and "properties" [{"label-value", "name", ...}]. Any thread may call it.

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
    std::vector<LabelLook> looks{};       ///< ascending; of a label that is named twice the first entry
    std::vector<std::string> warnings{};  ///< one for each of the two lists, of the first entry that is none
};

/// Empty where the folder is no label image. Fails where its .zattrs is no JSON.
LabelLooks read_label_looks(const std::filesystem::path& folder);

}  // namespace shvr
