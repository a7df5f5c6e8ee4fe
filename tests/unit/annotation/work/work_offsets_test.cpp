// Offsets as readers of voxels see them: components of a raised volume against a breadth-first search, and where
// offsets are loaded from.

#include "engine/annotation/work/work_offsets.h"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/files/offset_file.h"
#include "engine/components/components.h"
#include "tests/reference/components.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr int64_t SIDE = gpu::BRICK_SIZE;

int64_t index_in(const Size3& size, const Size3& at)
{
    return at.x + size.x * (at.y + size.y * at.z);
}

/// Gives the range of every brick and one voxel around, as a project does; callers that trust it skip the voxels.
class RangedSource final : public MemorySource {
public:
    RangedSource(const Size3& size, std::vector<uint8_t> voxels)
        : MemorySource(memory_source(size, VoxelType::uint8, voxels)), voxels_(std::move(voxels))
    {}
    std::optional<ValueRange> brick_range(int, const Size3& brick) const override
    {
        const Size3& size = info().size;
        const Size3 lower = glm::max(SIDE * brick - int64_t{1}, Size3(0));
        const Size3 upper = glm::min(SIDE * (brick + int64_t{1}) + int64_t{1}, size);
        ValueRange range{1e9, -1e9};
        for (int64_t z = lower.z; z < upper.z; ++z)
            for (int64_t y = lower.y; y < upper.y; ++y)
                for (int64_t x = lower.x; x < upper.x; ++x) {
                    const double voxel = voxels_[size_t(index_in(size, {x, y, z}))];
                    range = {std::min(range.lower, voxel), std::max(range.upper, voxel)};
                }
        return range;
    }

private:
    std::vector<uint8_t> voxels_;
};

std::vector<uint32_t> labels_of(const VolumeSource& source)
{
    const Size3 size = source.info().size;
    std::vector<uint32_t> labels(size_t(size.x * size.y * size.z));
    const auto fill = [&]<class T>(T) {
        std::vector<T> voxels(labels.size());
        source.read({{0, 0, 0}, size}, std::as_writable_bytes(std::span(voxels)));
        std::ranges::copy(voxels, labels.begin());
    };
    if (source.info().type == VoxelType::uint8)
        fill(uint8_t{});
    else if (source.info().type == VoxelType::uint16)
        fill(uint16_t{});
    else
        fill(uint32_t{});
    return labels;
}

class Painted {
public:
    explicit Painted(const Size3& size) : field(size, VoxelType::uint8) {}

    void put(const Size3& voxel, int offset)
    {
        if (offset == 0) return;
        const Size3 in = voxel % SIDE;
        const uint32_t bits = offset_bits(VoxelType::uint8, offset);
        const auto at = uint16_t(in.x + SIDE * (in.y + SIDE * in.z));
        const Size3 counts = field.brick_counts(), brick = voxel / SIDE;
        field.apply({brick.x + counts.x * (brick.y + counts.y * brick.z), {{at, at, 0, bits}}}, Direction::forwards);
    }
    DensityField field;
};

/// Components of the raised volume are those that a search finds in voxels raised one by one.
int64_t check_components(const Size3& size, const std::vector<uint8_t>& voxels, const DensityField& field,
                         int connectivity)
{
    const auto source = with_offsets(std::make_shared<RangedSource>(size, voxels), field);
    const ComponentOptions options{.threshold = 100.0,
                                   .connectivity = connectivity == 6 ? Connectivity::faces : Connectivity::corners,
                                   .threads = 2,
                                   .run_folder = std::filesystem::temp_directory_path()};
    const auto components = find_components(*source, options);
    const auto open = [&](const Size3& at) {
        return std::clamp(double(voxels[size_t(index_in(size, at))]) + field.at(at), 0.0, 255.0) >= 100.0;
    };
    CHECK((labels_of(*components->labels()) == reference::component_labels(size, open, connectivity)));
    return components->counts().found;
}

}  // namespace

TEST_CASE("components are those of the voxels with their offsets, in noise")
{
    const Size3 size(70, 45, 39);
    std::mt19937 random(11);
    std::vector<uint8_t> voxels(size_t(size.x * size.y * size.z));
    Painted painted(size);
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) {
                voxels[size_t(index_in(size, {x, y, z}))] = uint8_t(random() % 160);
                if (x < SIDE && random() % 3 == 0) painted.put({x, y, z}, int(random() % 511) - 255);
            }
    for (const int connectivity : {6, 26}) {
        const int64_t raised = check_components(size, voxels, painted.field, connectivity);
        CHECK(raised != check_components(size, voxels, DensityField(size, VoxelType::uint8), connectivity));
    }
}

TEST_CASE("offsets open a path between two chambers, and close it, where ranges of bricks say that nothing is there")
{
    const Size3 size(100, 40, 36);
    std::vector<uint8_t> voxels(size_t(size.x * size.y * size.z), 20);
    for (int64_t z = 2; z < 6; ++z)
        for (int64_t y = 2; y < 6; ++y)
            for (const int64_t x : {2, 3, 4, 95, 96, 97}) voxels[size_t(index_in(size, {x, y, z}))] = 150;
    Painted painted(size);
    CHECK(check_components(size, voxels, painted.field, 6) == 2);
    for (int64_t x = 5; x < 95; ++x)
        if (x != 50) painted.put({x, 4, 4}, 80);
    CHECK(check_components(size, voxels, painted.field, 6) == 2);
    painted.put({50, 4, 4}, 79);  // 99 is below
    CHECK(check_components(size, voxels, painted.field, 6) == 2);
    Painted whole(size);
    for (int64_t x = 5; x < 95; ++x) whole.put({x, 4, 4}, 80);
    CHECK(check_components(size, voxels, whole.field, 6) == 1);
    // The same corridor in the volume itself, and one voxel of it lowered.
    for (int64_t x = 5; x < 95; ++x) voxels[size_t(index_in(size, {x, 4, 4}))] = 100;
    Painted closed(size);
    CHECK(check_components(size, voxels, closed.field, 26) == 1);
    closed.put({63, 4, 4}, -1);
    CHECK(check_components(size, voxels, closed.field, 26) == 2);
}

TEST_CASE("a volume without offsets is handed on as it is")
{
    const auto base = std::make_shared<RangedSource>(Size3(4, 4, 4), std::vector<uint8_t>(64));
    CHECK(with_offsets(base, DensityField({4, 4, 4}, VoxelType::uint8)) == base);
}

TEST_CASE("offsets come from the journal, or from their file, and then no other file is looked at")
{
    const TemporaryFolder folder;
    const Size3 size(40, 8, 8);
    const VolumeInfo volume{.name = "a", .format = "memory", .size = size, .type = VoxelType::uint8};
    const WorkFiles files{.journal = folder.path / "a.journal",
                          .mask = folder.path / "a.mask",
                          .trace = folder.path / "a.graphml",
                          .density = folder.path / "a.offset",
                          .volume = volume};
    std::vector<Notice> messages;
    CHECK(offsets_of(files, Belief::ask, messages).voxels() == 0);
    CHECK(offsets_of({.volume = volume}, Belief::ask, messages).voxels() == 0);
    Painted painted(size);
    painted.put({35, 3, 3}, 7);
    save_offsets(files.density, painted.field);
    folder.write("a.mask", "of another volume");
    folder.write("a.graphml", "no trace");
    CHECK(offsets_of(files, Belief::ask, messages).at({35, 3, 3}) == 7.0);
    std::filesystem::remove(files.mask);
    std::filesystem::remove(files.trace);
    CHECK(messages.empty());
    {
        Work work(size, VoxelType::uint8);
        work.open(files);
        const uint32_t bits = offset_bits(VoxelType::uint8, 9);
        work.perform({.label = "raise", .changes = {DensityBrickChange{0, {{0, 1, 0, bits}}}}});
        work.flush();
    }
    const std::string before = bytes_of_file(files.journal);
    const DensityField found = offsets_of(files, Belief::ask, messages);
    CHECK(found.voxels() == 3);
    CHECK(found.at({1, 0, 0}) == 9.0);
    CHECK(messages.size() == 1);  // a step that is not saved
    CHECK(bytes_of_file(files.journal) == before);
    // A file that cannot be intentional: the journal's content is used.
    folder.write("a.offset", "short");
    CHECK(offsets_of(files, Belief::ask, messages).voxels() == 3);
    CHECK(contains(messages.back().text, "a.offset: holds 5 bytes"));
    CHECK(messages.back().is_loss);
    // A file that may be intentional.
    painted.put({35, 3, 4}, 2);
    save_offsets(files.density, painted.field);
    CHECK_THROWS_AS(offsets_of(files, Belief::ask, messages), Disputed);
    CHECK(offsets_of(files, Belief::files, messages).voxels() == 2);
    CHECK(offsets_of(files, Belief::journal, messages).voxels() == 3);
}
