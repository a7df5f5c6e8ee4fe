#pragma once
// Shared by the tests of engine/volume: a temporary folder, volumes in memory, and reading whole volumes at once.

#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/volume/source.h"

namespace shvr::test {

class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "shvr_volume_XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) fail(pattern, ": cannot be made");
        path = pattern;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }

    std::filesystem::path write(const std::string& name, std::string_view content) const
    {
        // A new file rather than a truncated one: some file systems wait for the disk when those are closed.
        std::filesystem::remove(path / name);
        std::ofstream file(path / name, std::ios::binary);
        file.write(content.data(), std::streamsize(content.size()));
        return path / name;
    }

    std::filesystem::path path;
};

inline std::string bytes_of_file(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A volume that is a block of memory.
class MemorySource : public VolumeSource {
public:
    MemorySource(VolumeInfo info, std::vector<std::byte> voxels)
        : VolumeSource(std::move(info)), voxels_(std::move(voxels))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const size_t voxel_bytes = bytes_of(info().type);
        const size_t row_bytes = size_t(box.size().x) * voxel_bytes;
        std::byte* row = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
            for (int64_t y = box.lower.y; y < box.upper.y; ++y, row += row_bytes) {
                const int64_t first = box.lower.x + info().size.x * (y + info().size.y * z);
                std::memcpy(row, voxels_.data() + size_t(first) * voxel_bytes, row_bytes);
            }
        }
    }

private:
    std::vector<std::byte> voxels_;
};

template <class T>
MemorySource memory_source(const Size3& size, VoxelType type, const std::vector<T>& voxels)
{
    VolumeInfo info;
    info.name = "memory";
    info.size = size;
    info.type = type;
    const auto bytes = std::as_bytes(std::span(voxels));
    return {std::move(info), {bytes.begin(), bytes.end()}};
}

template <class T>
std::vector<T> voxels_in(const VolumeSource& source, const VoxelBox& box)
{
    std::vector<T> voxels(size_t(box.size().x * box.size().y * box.size().z));
    source.read(box, std::as_writable_bytes(std::span(voxels)));
    return voxels;
}

template <class T>
std::vector<T> voxels_of(const VolumeSource& source)
{
    return voxels_in<T>(source, {Size3(0), source.info().size});
}

/// All voxels of a level of a pyramid.
template <class T>
std::vector<T> level_of(const VolumeSource& source, int level)
{
    const Size3 size = size_of_level(source.info().size, level);
    std::vector<T> voxels(size_t(size.x * size.y * size.z));
    source.read_level(level, {Size3(0), size}, std::as_writable_bytes(std::span(voxels)));
    return voxels;
}

/// A volume without voxels, for code that depends on its position and size alone.
inline VolumeInfo volume_of_size(const Size3& size, const glm::dvec3& spacing = glm::dvec3(1.0))
{
    VolumeInfo volume;
    volume.size = size;
    volume.spacing = spacing;
    return volume;
}

/// 5 x 4 x 3 voxels of 16 bits, x + 10 y + 100 z - 99 each, in many formats; tests run in the repository's root.
inline const std::filesystem::path CHIRALITY = "tests/data/chirality";

inline bool is_chirality_phantom(const VolumeSource& source)
{
    if (source.info().size != Size3(5, 4, 3) || source.info().type != VoxelType::int16) return false;
    const std::vector<int16_t> voxels = voxels_of<int16_t>(source);
    for (int i = 0; i < 60; ++i) {
        if (voxels[size_t(i)] != i % 5 + 10 * (i / 5 % 4) + 100 * (i / 20) - 99) return false;
    }
    return true;
}

/// The message of the `Error` that `action` throws; empty if it throws none.
template <class Action>
std::string error_of(const Action& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

/// The resources this process used since construction. Tests check "refused at once" by it rather than by time, which
/// depends on the machine: code that goes through a claimed size reads the bytes or touches the memory.
class Effort {
public:
    int64_t bytes_read() const { return read_so_far() - read_; }
    int64_t bytes_touched() const { return touched_so_far() - touched_; }
    bool is_below(int64_t bytes) const { return bytes_read() < bytes && bytes_touched() < bytes; }

private:
    /// Through system calls; mapped pages count as touched.
    static int64_t read_so_far()
    {
        std::ifstream io("/proc/self/io");
        std::string name;
        int64_t bytes = -1;
        io >> name >> bytes;  // rchar comes first
        REQUIRE(name == "rchar:");
        return bytes;
    }
    static int64_t touched_so_far()
    {
        rusage usage{};
        ::getrusage(RUSAGE_SELF, &usage);
        return (usage.ru_minflt + usage.ru_majflt) * ::sysconf(_SC_PAGESIZE);
    }

    int64_t read_ = read_so_far();
    int64_t touched_ = touched_so_far();
};
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// Sanitizers do not soon reuse freed memory, and touch their shadow of each byte, too.
constexpr int64_t AT_ONCE_BYTES = 64 << 20;
#else
constexpr int64_t AT_ONCE_BYTES = 32 << 20;
#endif

inline bool contains(std::string_view text, std::string_view part)
{
    return text.find(part) != std::string_view::npos;
}

inline bool warns_of(const VolumeSource& source, std::string_view part)
{
    for (const std::string& warning : source.info().warnings) {
        if (contains(warning, part)) return true;
    }
    return false;
}

}  // namespace shvr::test
