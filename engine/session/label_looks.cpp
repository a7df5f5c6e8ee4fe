#include "engine/session/label_looks.h"

#include <algorithm>
#include <cmath>

#include "engine/annotation/files/mask_import.h"
#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/base/text.h"
#include "engine/formats/nrrd_head.h"
#include "engine/formats/zarr/ome_zarr_labels.h"

namespace shvr {

namespace {

uint8_t byte_of(double share)
{
    return uint8_t(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}

std::array<uint8_t, 4> rgba_of(const ColorGroup& look)
{
    const auto channel = [&](int index) { return byte_of(srgb_encode(std::clamp(look.color[index], 0.0, 1.0))); };
    return {channel(0), channel(1), channel(2), byte_of(look.opacity)};
}

GroupSettings settings_of(const LabelLook& look, const ColorGroup& standard)
{
    GroupSettings settings;
    if (look.name != standard.name) settings.name = look.name;
    if (!look.rgba) return settings;
    const std::array<uint8_t, 4>&rgba = *look.rgba, usual = rgba_of(standard);
    if (!std::equal(rgba.begin(), rgba.begin() + 3, usual.begin()))
        settings.color = {srgb_decode(rgba[0] / 255.0), srgb_decode(rgba[1] / 255.0), srgb_decode(rgba[2] / 255.0)};
    if (rgba[3] != usual[3]) settings.opacity = rgba[3] / 255.0;
    return settings;
}

/// Reads the segments of a 3D Slicer segmentation, whose colours are sRGB values from 0 to 1.
LabelLooks looks_in_segments(const std::filesystem::path& file, const NrrdHead& head)
{
    LabelLooks read;
    for (const NrrdSegment& segment : segments_of(head)) {
        LabelLook look{.value = segment.group, .name = segment.name};
        const std::vector<std::string_view> words = words_of(segment.color);
        // Uses the default opacity, since the file does not state one.
        std::array<uint8_t, 4> rgba = rgba_of(default_group(uint8_t(std::clamp<int64_t>(look.value, 1, 255))));
        bool is_color = words.size() == 3;
        for (size_t channel = 0; is_color && channel < 3; ++channel) {
            const double share = number_of(words[channel]).value_or(-1.0);
            is_color = share >= 0.0 && share <= 1.0;
            if (is_color) rgba[channel] = byte_of(share);
        }
        if (is_color)
            look.rgba = rgba;
        else if (!segment.color.empty())
            read.warnings.push_back(sentence(file.string(), ": Segment", segment.number, "_Color is ",
                                             in_quotes(segment.color),
                                             "; expected three numbers from 0 to 1; it is left out"));
        read.looks.push_back(std::move(look));
    }
    if (read.warnings.size() > 1) read.warnings.resize(1);
    return read;
}

}  // namespace

std::vector<LabelImage::Color> label_looks(const Groups& groups, const Mask& mask)
{
    std::vector<LabelImage::Color> looks;
    const std::array<int64_t, 256> voxels = mask.voxels_by_group();
    for (int group = 1; group < 256; ++group) {
        if (voxels[size_t(group)] == 0 && !groups.contains(uint8_t(group))) continue;
        const ColorGroup look = group_of(groups, uint8_t(group));
        looks.push_back({group, rgba_of(look), look.name});
    }
    return looks;
}

std::vector<std::string> take_label_looks(const std::filesystem::path& stated, Groups& groups)
{
    if (stated.empty()) return {};
    std::error_code ignored;
    const std::filesystem::path saved = saved_mask_path(stated);
    const std::filesystem::path& mask = std::filesystem::exists(saved, ignored) ? saved : stated;
    LabelLooks read;
    try {
        const std::optional<NrrdHead> head = read_nrrd_head(mask);
        read = head ? looks_in_segments(mask, *head) : read_label_looks(mask);
    } catch (const Error& error) {
        return {error.what()};  // the mask's reader reports the details
    }
    for (const LabelLook& look : read.looks) {
        if (look.value < 1 || look.value > 255 || groups.contains(uint8_t(look.value))) continue;
        const GroupSettings settings = settings_of(look, default_group(uint8_t(look.value)));
        if (settings != GroupSettings{}) groups[uint8_t(look.value)] = settings;
    }
    return read.warnings;
}

}  // namespace shvr
