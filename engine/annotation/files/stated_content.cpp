#include "engine/annotation/files/stated_content.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "engine/annotation/files/volume_place.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/export/volume_export.h"
#include "engine/formats/tiff/tiff_description.h"
#include "engine/formats/zarr/ome_zarr_labels.h"
#include "engine/volume/voxel_dispatch.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {

namespace {

constexpr size_t HEADER_BYTES = size_t{64} << 10;
constexpr int MAX_LABELS = 64;
/// Minimum share of equal values among neighbouring voxels that are not 0: in a label image, only borders differ.
constexpr double MIN_EQUAL = 0.9;

/// The first lines of an NRRD file, up to its voxels; empty for any other file.
std::string nrrd_header(const std::filesystem::path& path)
{
    std::string header(HEADER_BYTES, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(header.data(), std::streamsize(header.size()));
    header.resize(size_t(file.gcount()));
    if (!header.starts_with("NRRD")) return {};
    std::erase(header, '\r');
    return header.substr(0, header.find("\n\n"));
}

/// The content that a TIFF's description states; empty for other files and for files that cannot be read.
std::string content_in_tiff(const std::filesystem::path& path)
{
    try {
        return content_of_tiff(path);
    } catch (const Error&) {
        return {};
    }
}

/// Counts the different values of a volume, and the pairs of neighbours along x with equal values.
struct ValueCounts {
    std::array<bool, 256> is_there{};
    int values = 0;
    int64_t pairs = 0, equal = 0;  ///< pairs of neighbours that are not 0; equal pairs
    bool are_labels = true;        ///< false: a value does not fit into a mask, or there are too many different values

    template <class T>
    void add_row(const T* row, int64_t count)
    {
        T before{0};
        for (const T* voxel = row; voxel != row + count && are_labels; ++voxel) {
            const auto value = int64_t(*voxel);
            if (value < 0 || value > 255)
                are_labels = false;
            else if (!std::exchange(is_there[size_t(value)], true))
                are_labels = ++values <= MAX_LABELS;
            if (before != T{0} && *voxel != T{0}) {
                ++pairs;
                equal += before == *voxel;
            }
            before = *voxel;
        }
    }
};

/// The voxels that `measure` would read.
VoxelWalk walk_through(const VolumeSource& source)
{
    const auto size = glm::dvec3(source.info().size);
    if (size.x * size.y * size.z <= double(MAX_VOXELS_MEASURED)) return VoxelWalk::all(source);
    std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
    const bool is_sparse = stored && voxels_stored(*stored, source.info().size) <= MAX_VOXELS_MEASURED;
    return is_sparse ? VoxelWalk::stored(source, *std::move(stored)) : VoxelWalk::sample(source);
}

ValueCounts count_values(const VolumeSource& source, const VoxelWalk& walk)
{
    ValueCounts counts;
    counts.is_there[0] = true;
    counts.values = 1;
    std::vector<std::byte> voxels;
    for (int64_t index = 0; index < walk.boxes() && counts.are_labels; ++index) {
        const VoxelBox box = walk.box(index);
        const int64_t rows = box.size().y * box.size().z, row = box.size().x;
        voxels.resize(size_t(rows * row * bytes_of(source.info().type)));
        source.read(box, voxels);
        with_voxel_type(source.info().type, [&]<class T>(T) {
            const T* const values = reinterpret_cast<const T*>(voxels.data());
            for (int64_t each = 0; each < rows && counts.are_labels; ++each) counts.add_row(values + each * row, row);
        });
    }
    return counts;
}

std::string values_in_words(const ValueCounts& counts)
{
    std::vector<size_t> values;
    for (size_t value = 0; value < counts.is_there.size(); ++value)
        if (counts.is_there[value]) values.push_back(value);
    if (values.size() == 2) return sentence(values[0], " and ", values[1]);
    if (values.back() + 1 == values.size()) return sentence("0 to ", values.back());
    if (values.size() == 3) return sentence(values[0], ", ", values[1], " and ", values[2]);
    return sentence("0 to ", values.back(), ", ", values.size(), " different ones");
}

}  // namespace

std::string labels_in_words(const VolumeSource& source, const VolumeStatistics& statistics)
{
    if (is_float(source.info().type) || statistics.minimum != 0.0 || statistics.maximum < 1.0 ||
        statistics.maximum > 255.0)
        return {};
    const auto bins = std::ranges::count_if(statistics.histogram, [](int64_t voxels) { return voxels > 0; });
    if (statistics.measured_level == 0 && bins > MAX_LABELS) return {};
    const VoxelWalk walk = walk_through(source);
    const ValueCounts counts = count_values(source, walk);
    const bool has_labels = counts.are_labels && counts.values > 1 && (walk.rest() == 0 || walk.fill() == 0.0);
    if (!has_labels || double(counts.equal) < MIN_EQUAL * double(counts.pairs)) return {};
    const bool is_sample = double(walk.voxels()) + double(walk.rest()) < double(voxel_count(source.info()));
    return "its voxels have the values " + values_in_words(counts) + " only" +
           (is_sample ? ", as far as a sample shows" : "");
}

std::optional<StatedContent> stated_content(const std::filesystem::path& path)
{
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored) || is_in_archive(path))
        return is_ome_zarr_label(path) ? std::optional(StatedContent::mask) : std::nullopt;
    const std::string header = nrrd_header(path);
    if (header.empty()) {
        const std::string content = content_in_tiff(path);
        if (content == "mask") return StatedContent::mask;
        return content == "offsets" ? std::optional(StatedContent::offsets) : std::nullopt;
    }
    const std::string key = std::string("\n") + NRRD_CONTENT_KEY + ":=";
    const auto has = [&](const std::string& text) { return header.find(text) != std::string::npos; };
    if (has("\nSegment0_") || has(key + "mask")) return StatedContent::mask;
    if (has(key + "offsets")) return StatedContent::offsets;
    return std::nullopt;
}

}  // namespace shvr
