#include "engine/annotation/files/mask_segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/annotation/files/mask_source.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/ome_zarr_labels.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Returns the box around the voxels of each group. For a group without voxels, lower > upper.
std::array<VoxelBox, 256> boxes_of(const Mask& mask)
{
    std::array<VoxelBox, 256> boxes;
    boxes.fill({mask.size(), Size3(0)});
    for (const int64_t index : mask.painted_bricks()) {
        const auto brick = mask.brick(index);
        const Size3 corner = mask.box_of(index).lower;
        size_t at = 0;
        for (int64_t z = 0; z < BRICK_SIDE; ++z)
            for (int64_t y = 0; y < BRICK_SIDE; ++y)
                for (int64_t x = 0; x < BRICK_SIDE; ++x) {
                    const uint8_t group = (*brick)[at++];
                    if (group == 0) continue;
                    VoxelBox& box = boxes[group];
                    const Size3 voxel = corner + Size3(x, y, z);
                    box.lower = glm::min(box.lower, voxel);
                    box.upper = glm::max(box.upper, voxel + Size3(1));
                }
    }
    return boxes;
}

/// The extent of a box as text: "5 9 5 9 5 9", where both ends are included; "0 -1 0 -1 0 -1" for an empty segment.
std::string extent_of(const VoxelBox& box)
{
    if (box.lower.x >= box.upper.x) return "0 -1 0 -1 0 -1";
    std::string text;
    for (int axis = 0; axis < 3; ++axis)
        text += sentence(axis > 0 ? " " : "", box.lower[axis], " ", box.upper[axis] - 1);
    return text;
}

/// Whether the text states this colour as three fractions, up to rounding to 8 bits per channel.
bool states_color(const std::string& text, const std::array<uint8_t, 4>& rgba)
{
    const std::vector<std::string_view> words = words_of(text);
    if (words.size() != 3) return false;
    for (size_t channel = 0; channel < 3; ++channel) {
        const std::optional<double> share = number_of(words[channel]);
        if (!share || !(std::abs(*share * 255.0 - rgba[channel]) <= 0.5)) return false;
    }
    return true;
}

std::string color_text(const std::array<uint8_t, 4>& rgba)
{
    const auto share = [&](size_t channel) { return digits_of(std::round(1e6 * rgba[channel] / 255.0) / 1e6); };
    return share(0) + " " + share(1) + " " + share(2);
}

std::unique_ptr<VolumeSource> open_layer(const std::filesystem::path& path, int64_t layer)
{
    return open_volume(path, {.channel = std::to_string(layer + 1)});
}

VolumeInfo info_of_groups(const std::filesystem::path& path)
{
    VolumeInfo info = open_layer(path, 0)->info();
    info.type = VoxelType::uint8;
    return info;
}

void add_missing_segments(NrrdHead& head, const NrrdHead& earlier)
{
    const std::vector<NrrdSegment> segments = segments_of(head);
    int64_t next = 0;
    for (const NrrdSegment& segment : segments) next = std::max(next, segment.number + 1);
    for (NrrdSegment segment : segments_of(earlier)) {
        const std::vector<NrrdPair> pairs = pairs_of(earlier, segment);
        const auto found = std::ranges::find(segments, segment.group, &NrrdSegment::group);
        const bool is_new = found == segments.end();
        segment.number = is_new ? next++ : found->number;
        const std::vector<NrrdPair> known = is_new ? std::vector<NrrdPair>() : pairs_of(head, *found);
        for (const NrrdPair& pair : pairs)
            if (std::ranges::find(known, pair.key, &NrrdPair::key) == known.end())
                head.pairs.push_back({segment_key(segment, pair.key), pair.value});
        if (!is_new) continue;
        // With a single layer, the number of a group is its label value.
        set_pair(head.pairs, segment_key(segment, "LabelValue"), std::to_string(segment.group));
        set_pair(head.pairs, segment_key(segment, "Layer"), "0");
    }
}

}  // namespace

std::optional<NrrdHead> mask_header(const std::filesystem::path& mask)
{
    if (mask.empty()) return std::nullopt;
    try {
        if (std::optional<NrrdHead> head = read_nrrd_head(mask)) return head;
        std::string text;
        for (const std::string& line : read_label_header(mask)) text += line + "\n";
        return nrrd_head_in(text);
    } catch (const Error&) {
        return std::nullopt;  // the mask's reader reports the details
    }
}

std::optional<NrrdHead> header_to_keep(const std::filesystem::path& path, const std::optional<NrrdHead>& earlier)
{
    std::optional<NrrdHead> head = mask_header(path);
    if (!head) return earlier;
    if (earlier && *earlier != *head) add_missing_segments(*head, *earlier);
    return head;
}

void describe_segments(NrrdHead& head, const std::filesystem::path& path, const Mask& mask,
                       const std::vector<LabelImage::Color>& looks)
{
    std::vector<NrrdSegment> segments = segments_of(head);
    if (segments.empty() && !lower_case(path.filename().string()).ends_with(".seg.nrrd")) return;
    const bool is_new = segments.empty();
    std::vector<NrrdPair>& pairs = head.pairs;
    const auto set = [&](const NrrdSegment& segment, const char* key, std::string value) {
        set_pair(pairs, segment_key(segment, key), std::move(value));
    };
    int64_t next = 0;
    for (const NrrdSegment& segment : segments) next = std::max(next, segment.number + 1);
    for (const LabelImage::Color& look : looks) {
        const auto found = std::ranges::find(segments, look.value, &NrrdSegment::group);
        if (found == segments.end()) {
            const NrrdSegment added{.number = next++, .label_value = look.value, .group = look.value};
            set(added, "ID", sentence("Segment_", look.value));
            set(added, "LabelValue", std::to_string(look.value));
            set(added, "Layer", "0");
            set(added, "Name", look.name);
            set(added, "Color", color_text(look.rgba));
            segments.push_back(added);
            continue;
        }
        if (!look.name.empty() && found->name != look.name) {
            set(*found, "Name", look.name);
            set(*found, "NameAutoGenerated", "0");
        }
        if (!states_color(found->color, look.rgba)) {
            set(*found, "Color", color_text(look.rgba));
            set(*found, "ColorAutoGenerated", "0");
        }
    }
    const std::array<VoxelBox, 256> boxes = boxes_of(mask);
    for (const NrrdSegment& segment : segments) {
        if (segment.group > 0 && segment.group < 256) set(segment, "Extent", extent_of(boxes[size_t(segment.group)]));
        // A saved mask has one layer.
        if (segment.layer != 0) set(segment, "Layer", "0");
        if (segment.group != segment.label_value) set(segment, "LabelValue", std::to_string(segment.group));
    }
    // 3D Slicer may crop a segmentation to its painted part; a saved mask covers the whole volume.
    set_pair(pairs, "Segmentation_ReferenceImageExtentOffset", "0 0 0");
    if (is_new) {
        set_pair(pairs, "Segmentation_ContainedRepresentationNames", "Binary labelmap|");
        set_pair(pairs, "Segmentation_MasterRepresentation", "Binary labelmap");
    }
}

LayeredMask::LayeredMask(const std::filesystem::path& path, int64_t layers, const std::vector<NrrdSegment>& segments)
    : VolumeSource(info_of_groups(path)), file_(path.string())
{
    for (int64_t layer = 0; layer < layers; ++layer) {
        layers_.push_back(open_layer(path, layer));
        std::array<uint8_t, 256>& groups = groups_.emplace_back();
        std::iota(groups.begin(), groups.end(), uint8_t{0});
        for (const NrrdSegment& segment : segments) {
            if (segment.layer != layer || segment.label_value < 1 || segment.label_value > 255) continue;
            if (segment.group > 255)
                fail(file_, ": its segments ", segment.number, " and others in several layers need ", segment.group,
                     " groups; expected at most 255: remove some of them");
            groups[size_t(segment.label_value)] = uint8_t(segment.group);
        }
    }
}

void LayeredMask::read(const VoxelBox& box, std::span<std::byte> voxels) const
{
    std::ranges::fill(voxels, std::byte{0});
    int64_t overlaps = 0;
    for (size_t layer = 0; layer < layers_.size(); ++layer) {
        const std::vector<uint8_t> values = groups_in(*layers_[layer], box, file_);
        for (size_t i = 0; i < values.size(); ++i) {
            if (values[i] == 0) continue;
            if (voxels[i] != std::byte{0}) ++overlaps;
            voxels[i] = std::byte{groups_[layer][values[i]]};
        }
    }
    overlaps_ += overlaps;
}

}  // namespace shvr
