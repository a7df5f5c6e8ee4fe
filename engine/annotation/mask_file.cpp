#include "engine/annotation/mask_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

namespace {

constexpr int64_t SIDE = gpu::BRICK_SIZE;

/// The rows of one slice that go through one row of bricks. They are consecutive in the file, and even the largest
/// volume's are only 32 MiB.
struct Strip {
    Size3 size;  ///< of the volume
    int64_t z, brick_y;
    int64_t height() const { return std::min(SIDE, size.y - brick_y * SIDE); }
    size_t bytes() const { return size_t(size.x * height()); }
};

template <class Visit>
void for_each_strip(const Size3& size, const Visit& visit)
{
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t brick_y = 0; brick_y * SIDE < size.y; ++brick_y) visit(Strip{size, z, brick_y});
}

/// The strip's rows within one brick: offset in the strip, offset in the brick, length.
template <class Visit>
void for_each_row(const Strip& strip, int64_t brick_x, const Visit& visit)
{
    const int64_t width = std::min(SIDE, strip.size.x - brick_x * SIDE);
    for (int64_t y = 0; y < strip.height(); ++y)
        visit(size_t(brick_x * SIDE + strip.size.x * y), size_t(SIDE * (y + SIDE * (strip.z % SIDE))), size_t(width));
}

/// Opens what holds exactly one byte for each voxel.
FileDescriptor open_mask(const std::filesystem::path& path, const Size3& size)
{
    // Without O_NONBLOCK, opening a FIFO waits for a writer before we can see that it is one.
    FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file) fail(path.string(), ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail(path.string(), ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) fail(path.string(), ": is a folder, device, pipe or socket; expected a .mask file");
    const int64_t voxels = size.x * size.y * size.z;
    if (status.st_size != voxels)
        fail(path.string(), ": holds ", status.st_size, " bytes; expected ", voxels, ", one for each voxel of ", size.x,
             " x ", size.y, " x ", size.z);
    return file;
}

void read_next(const FileDescriptor& file, const std::filesystem::path& path, std::span<uint8_t> bytes)
{
    while (!bytes.empty()) {
        const ssize_t count = ::read(file.number(), bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) fail(path.string(), ": became shorter while it was read; expected its size to stay");
        bytes = bytes.subspan(size_t(count));
    }
}

/// Appends a row of groups that begins at voxel `first` of a brick. Joins the last run where it can.
void append_runs(std::vector<MaskRun>& runs, std::span<const uint8_t> row, size_t first)
{
    for (size_t x = 0; x < row.size();) {
        const uint8_t group = row[x];
        size_t end = x + 1;
        while (end < row.size() && row[end] == group) ++end;
        if (group != 0) {
            const auto last = uint16_t(first + end - 1);
            if (!runs.empty() && runs.back().last + size_t{1} == first + x && runs.back().after == group)
                runs.back().last = last;
            else
                runs.push_back({uint16_t(first + x), last, 0, group});
        }
        x = end;
    }
}

}  // namespace

void save_mask(const std::filesystem::path& path, const Mask& mask)
{
    const glm::i64vec3 counts = mask.brick_counts();
    AtomicWriter writer(path);
    std::vector<uint8_t> bytes;
    for_each_strip(mask.size(), [&](const Strip& strip) {
        bytes.assign(strip.bytes(), 0);
        const int64_t first_brick = counts.x * (strip.brick_y + counts.y * (strip.z / SIDE));
        for (int64_t x = 0; x < counts.x; ++x) {
            const MaskBrick* brick = mask.brick(first_brick + x);
            if (!brick) continue;
            for_each_row(strip, x, [&](size_t in_strip, size_t in_brick, size_t width) {
                std::copy_n(brick->data() + in_brick, width, bytes.data() + in_strip);
            });
        }
        writer.append(std::as_bytes(std::span(bytes)));
    });
    writer.commit();
}

std::vector<MaskBrickChange> load_mask(const std::filesystem::path& path, const Size3& size)
{
    const FileDescriptor file = open_mask(path, size);
    const glm::i64vec3 counts = (size + Size3(SIDE - 1)) / Size3(SIDE);
    std::vector<MaskBrickChange> changes;
    std::vector<std::vector<MaskRun>> layer(size_t(counts.x * counts.y));  // of bricks; their runs so far
    std::vector<uint8_t> bytes;
    for_each_strip(size, [&](const Strip& strip) {
        bytes.resize(strip.bytes());
        read_next(file, path, bytes);
        const bool is_painted = std::any_of(bytes.begin(), bytes.end(), [](uint8_t group) { return group != 0; });
        for (int64_t x = 0; is_painted && x < counts.x; ++x)
            for_each_row(strip, x, [&](size_t in_strip, size_t in_brick, size_t width) {
                append_runs(layer[size_t(x + counts.x * strip.brick_y)], std::span(bytes).subspan(in_strip, width),
                            in_brick);
            });
        const bool ends_layer = (strip.z % SIDE == SIDE - 1 || strip.z == size.z - 1) && strip.brick_y == counts.y - 1;
        if (!ends_layer) return;
        for (size_t i = 0; i < layer.size(); ++i) {
            if (layer[i].empty()) continue;
            layer[i].shrink_to_fit();
            changes.push_back({int64_t(i) + counts.x * counts.y * (strip.z / SIDE), std::exchange(layer[i], {})});
        }
    });
    return changes;
}

}  // namespace shvr
