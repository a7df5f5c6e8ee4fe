#include "engine/volume/levels/pyramid_source.h"

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "engine/projects/import_volume.h"
#include "engine/volume/halving.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

template <class T>
std::vector<T> halved(const std::vector<std::vector<T>>& rows)
{
    HalvingRows<T> from;
    for (const std::vector<T>& row : rows) from.first[size_t(from.count++)] = row.data();
    std::vector<T> to((rows[0].size() + 1) / 2);
    halve_rows(from, int64_t(rows[0].size()), to.data());
    return to;
}

template <class T>
std::shared_ptr<const VolumeSource> noise(VoxelType type, const Size3& size)
{
    std::mt19937 numbers(5);
    std::vector<T> voxels(size_t(size.x * size.y * size.z));
    for (T& voxel : voxels) voxel = static_cast<T>(numbers());
    if constexpr (std::is_floating_point_v<T>) {
        for (size_t i = 0; i < voxels.size(); i += 3) voxels[i] = std::numeric_limits<T>::quiet_NaN();
        voxels[1] = std::numeric_limits<T>::infinity();
    }
    return std::make_shared<MemorySource>(memory_source(size, type, voxels));
}

}  // namespace

TEST_CASE("the mean of integers is rounded to nearest, ties to even, whatever their number")
{
    CHECK(halved<uint8_t>({{1, 2, 4}}) == std::vector<uint8_t>{2, 4});                      // 1.5
    CHECK(halved<uint8_t>({{0, 1, 5}, {0, 1, 6}}) == std::vector<uint8_t>{0, 6});           // 0.5, 5.5
    CHECK(halved<int8_t>({{-1, -2}, {-1, -2}}) == std::vector<int8_t>{-2});                 // -1.5
    CHECK(halved<int16_t>({{-3}, {-2}}) == std::vector<int16_t>{-2});                       // -2.5
    CHECK(halved<uint16_t>({{0, 1}, {1, 1}, {1, 0}, {0, 0}}) == std::vector<uint16_t>{0});  // 4 / 8
    CHECK(halved<uint16_t>({{0, 1}, {1, 1}, {1, 0}, {1, 0}}) == std::vector<uint16_t>{1});  // 5 / 8
    constexpr uint32_t MOST = std::numeric_limits<uint32_t>::max();
    CHECK(halved<uint32_t>({{MOST, MOST}, {MOST, MOST}, {MOST, MOST}, {MOST, MOST}}) == std::vector<uint32_t>{MOST});
    const std::vector<uint8_t> row(131, 9);
    CHECK(halved<uint8_t>({row, row}) == std::vector<uint8_t>(66, 9));
}

TEST_CASE("the mean of floats is that of the finite ones, NaN where there is none")
{
    constexpr float NONE = std::numeric_limits<float>::quiet_NaN();
    constexpr float ENDLESS = std::numeric_limits<float>::infinity();
    const std::vector<float> means =
        halved<float>({{1, 2, NONE, 4, NONE, ENDLESS, NONE}, {3, 5, 8, -ENDLESS, NONE, NONE, 7}});
    REQUIRE(means.size() == 4);
    CHECK(means[0] == 2.75f);
    CHECK(means[1] == 6.0f);
    CHECK(std::isnan(means[2]));
    CHECK(means[3] == 7.0f);
}

TEST_CASE("the most frequent label stays, of several one that is not 0, and of those the smallest")
{
    const auto label = [](const std::vector<std::vector<int16_t>>& rows) {
        HalvingRows<int16_t> from;
        for (const auto& row : rows) from.first[size_t(from.count++)] = row.data();
        std::vector<int16_t> to((rows[0].size() + 1) / 2);
        halve_rows(from, int64_t(rows[0].size()), to.data(), Halving::label);
        return to;
    };
    CHECK(label({{1, 9}, {9, 2}}) == std::vector<int16_t>{9});
    CHECK(label({{0, 0}, {7, 7}}) == std::vector<int16_t>{7});
    CHECK(label({{-4, 0}, {5, 0}, {-4, 0}, {5, 5}}) == std::vector<int16_t>{5});
    CHECK(label({{6, 5}, {5, 6}}) == std::vector<int16_t>{5});
    CHECK(label({{-4, -4}, {0, 0}}) == std::vector<int16_t>{-4});
    CHECK(label({{0, 0}, {0, 3}}) == std::vector<int16_t>{0});
    CHECK(label({{1, 2, 300}, {2, 2, 0}}) == std::vector<int16_t>{2, 300});
    CHECK(label({{8}}) == std::vector<int16_t>{8});
}

TEST_CASE("levels made in memory are those of a project, bit for bit")
{
    const Size3 size{70, 45, 39};
    for (const auto& source : {noise<uint8_t>(VoxelType::uint8, size), noise<int16_t>(VoxelType::int16, size),
                               noise<uint32_t>(VoxelType::uint32, size), noise<float>(VoxelType::float32, size)}) {
        CAPTURE(name_of(source->info().type));
        const TemporaryFolder folder;
        import_volume(*source, folder.path / "source", folder.path / "project", {});
        const auto project = open_volume(folder.path / "project");
        const auto levels = with_levels(source, uint64_t{4} << 30);
        REQUIRE(levels->levels() == project->levels());
        for (int level = 0; level < levels->levels(); ++level) {
            const VoxelBox all{Size3(0), size_of_level(size, level)};
            std::vector<std::byte> ours(size_t(all.upper.x * all.upper.y * all.upper.z) *
                                        bytes_of(source->info().type));
            std::vector<std::byte> theirs(ours.size());
            levels->read_level(level, all, ours);
            project->read_level(level, all, theirs);
            CHECK(ours == theirs);
        }
    }
}

TEST_CASE("levels that would take too much memory are refused before anything is read, and it is said what would do")
{
    // Levels of 35 x 23 x 20, 18 x 12 x 10 voxels; two slices of 70 x 45.
    const uint64_t bytes = 2 * (35 * 23 * 20 + 18 * 12 * 10 + 2 * 70 * 45);
    const auto source = noise<uint16_t>(VoxelType::uint16, {70, 45, 39});
    CHECK(error_of([&] { with_levels(source, 4 * bytes - 1); }) ==
          "memory: is drawn in pieces, and making its coarser levels takes 1 MiB; expected at most 0 MiB, a quarter of "
          "--budget-host: use --budget-host 1, or make a project with `shvr import FILE PROJECT` and open that");
    CHECK(with_levels(source, 4 * bytes)->levels() == 3);

    class Flat final : public VolumeSource {
    public:
        Flat() : VolumeSource({.name = "flat", .size = {1 << 17, 1 << 15, 2}, .type = VoxelType::uint8}) {}
        void read(const VoxelBox& /*box*/, std::span<std::byte> /*voxels*/) const override { fail("was read"); }
    };
    // The two slices are the whole volume, 8 GiB; its levels take (1 + 1/4 + ...) GiB.
    CHECK(contains(error_of([&] { with_levels(std::make_shared<Flat>(), uint64_t{24} << 30); }),
                   "takes 9558 MiB; expected at most 6144 MiB, a quarter of --budget-host: use --budget-host 38230,"));
}

TEST_CASE("what levels would take is checked from sizes alone")
{
    class Unread final : public VolumeSource {
    public:
        Unread() : VolumeSource({.name = "flat", .size = Size3(2714), .type = VoxelType::uint8}) {}
        void read(const VoxelBox& /*box*/, std::span<std::byte> /*voxels*/) const override { fail("was read"); }
    };
    CHECK(contains(error_of([&] { planned_levels(Unread(), uint64_t{2} << 30); }),
                   "takes 2739 MiB; expected at most 512"));
    CHECK(error_of([&] { planned_levels(Unread(), uint64_t{12} << 30); }).empty());
}
