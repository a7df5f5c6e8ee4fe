#include "tests/fuzz/support/volume_input.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "engine/formats/zarr/project.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

namespace shvr::fuzz {
namespace {

constexpr int64_t MAX_SIDE = int64_t{1} << 20;
/// Larger volumes are read in a few places only.
constexpr int64_t MAX_VOXELS_READ = int64_t{1} << 16;
constexpr int MAX_LEVELS_READ = 4;
constexpr int64_t BOX_SIDE = 8;

bool is_plain(const std::string& text)
{
    return text.size() < 4096 && std::none_of(text.begin(), text.end(), [](char letter) {
               const auto byte = static_cast<unsigned char>(letter);
               return byte < 0x20 || byte == 0x7f;
           });
}

/// Few enough voxels to go through; never overflows.
bool is_small(const Size3& size)
{
    return size.x * size.y <= MAX_VOXELS_READ && size.x * size.y * size.z <= MAX_VOXELS_READ;
}

void check_info(const VolumeInfo& info)
{
    for (int axis = 0; axis < 3; ++axis) {
        expect(info.size[axis] >= 1 && info.size[axis] <= MAX_SIDE, sentence("a side of ", info.size[axis]));
        expect(info.spacing[axis] >= 1e-12 && info.spacing[axis] <= 1e12,
               sentence("a spacing of ", info.spacing[axis]));
        expect(is_finite(info.directions[axis]), "a direction that is not finite");
        expect(std::abs(glm::length(info.directions[axis]) - 1.0) < 1e-6,
               sentence("a direction ", glm::length(info.directions[axis]), " long"));
    }
    expect(is_finite(info.origin), "an origin that is not finite");
    expect(glm::determinant(info.directions) > 0.0, "axes that are not right-handed");
    expect(is_plain(info.name) && is_plain(info.format) && is_plain(info.unit) && is_plain(info.frame),
           "a name, unit or frame with control characters: " + info.unit + info.frame);
    expect(info.warnings.size() < 64, sentence(info.warnings.size(), " warnings"));
    for (const std::string& warning : info.warnings) expect(is_plain(warning), "a warning that is not plain");
}

std::vector<std::byte> read(const VolumeSource& source, int level, const VoxelBox& box)
{
    const Size3 size = box.size();
    std::vector<std::byte> voxels(size_t(size.x * size.y * size.z) * bytes_of(source.info().type));
    source.read_level(level, box, voxels);
    return voxels;
}

/// Checks that reading a box gives that part of the whole.
void check_part(const VolumeSource& source, const std::vector<std::byte>& whole, const VoxelBox& box)
{
    const Size3 size = source.info().size;
    const std::vector<std::byte> part = read(source, 0, box);
    const auto voxel_bytes = int64_t(bytes_of(source.info().type));
    const int64_t row_bytes = box.size().x * voxel_bytes;
    auto row = part.begin();
    for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
        for (int64_t y = box.lower.y; y < box.upper.y; ++y, row += row_bytes) {
            const int64_t first = (box.lower.x + size.x * (y + size.y * z)) * voxel_bytes;
            expect(std::equal(row, row + row_bytes, whole.begin() + first), "a box that differs from the whole");
        }
    }
}

void try_level(const VolumeSource& source, int level)
{
    const Size3 size = size_of_level(source.info().size, level);
    const Size3 half = size / int64_t{2};
    const Size3 side = glm::min(size, Size3(BOX_SIDE));
    const VoxelBox boxes[] = {{Size3(0), Size3(1)},
                              {size - Size3(1), size},
                              {Size3(0), {std::min(size.x, int64_t{4096}), 1, 1}},
                              {half, glm::min(size, half + side)},
                              {size - side, size}};
    const bool reads_all = is_small(size);
    for (const VoxelBox& box : boxes) passes([&] { read(source, level, box); });
    for (const Size3& brick : {Size3(0), (size - Size3(1)) / int64_t{32}}) {
        passes([&] { static_cast<void>(source.brick_range(level, brick)); });
    }
    if (!reads_all) return;
    std::vector<std::byte> whole;
    if (!passes([&] { whole = read(source, level, {Size3(0), size}); }) || level > 0) return;
    for (const VoxelBox& box : boxes) check_part(source, whole, box);
}

}  // namespace

void try_source(const VolumeSource& source)
{
    check_info(source.info());
    expect(source.levels() >= 1 && source.levels() <= 32, sentence(source.levels(), " levels"));
    expect(glm::all(glm::greaterThan(source.block(), Size3(0))), "a block without voxels");
    // A volume that opens can be imported, and the project's record is read again. Statistics of a volume without
    // finite voxels are all 0, as here.
    ProjectRecord kept{.info = source.info(), .content_hash = "0", .source = "a"};
    kept.statistics.histogram.assign(256, 0);
    const std::string record = to_text(kept);
    expect(passes([&] { read_project_record(input_folder().write("record of the import", record)); }),
           "a record that cannot be read: " + last_outcome().refusal);
    for (int level = 0; level < std::min(source.levels(), MAX_LEVELS_READ); ++level) try_level(source, level);
    if (is_small(source.info().size)) {
        passes([&] { warnings_of(measure(source)); });
    }
}

void try_volume(const std::filesystem::path& path)
{
    std::unique_ptr<VolumeSource> source;
    if (!accepts([&] { source = open_volume(path); })) {
        // With more than one volume in the file, take the first.
        if (last_outcome().refusal.find("hoose ") == std::string::npos) return;
        passes([&] { source = open_volume(path, {.channel = "1"}); });
        if (!source) passes([&] { source = open_volume(path, {.channel = "1", .frame = "1"}); });
        if (!source) passes([&] { source = open_volume(path, {.frame = "1"}); });
        if (!source) return;
        last_outcome().was_accepted = true;
    }
    try_source(*source);
}

}  // namespace shvr::fuzz
