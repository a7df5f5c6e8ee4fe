#pragma once
// A volume's voxels as a sequence of bytes: raw in a file, deflated, or spread over several files. source_raw.cpp turns
// the bytes into voxels.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/file.h"

namespace shvr {

class VoxelBytes {
public:
    virtual ~VoxelBytes() = default;
    /// Fills `bytes` with the data from `offset` on. Throws `Error` if the data ends too early. Any thread may call it.
    virtual void read(int64_t offset, std::span<std::byte> bytes) const = 0;
};

/// A regular file, open for reading.
struct InputFile {
    std::filesystem::path path{};
    FileDescriptor descriptor;
    int64_t bytes = 0;

    /// Reads bytes from `offset` on. Returns the number of bytes read, smaller than the buffer only at the end of the
    /// file.
    size_t read_some(int64_t offset, std::span<std::byte> buffer) const;
};
/// Opens a regular file. Fails for folders, pipes and devices, and never blocks on them.
InputFile open_input_file(const std::filesystem::path& path);

/// Returns the bytes of `file` from `offset` on. They are read with pread and never mapped, so truncating the open file
/// causes an `Error` instead of a signal.
std::unique_ptr<VoxelBytes> bytes_of_file(InputFile file, int64_t offset);

/// Concatenates `count` parts of `share_bytes` bytes each. `open(i)` opens part i on demand; a few parts are kept
/// open.
std::unique_ptr<VoxelBytes> bytes_of_parts(size_t count, int64_t share_bytes,
                                           std::function<std::unique_ptr<VoxelBytes>(size_t)> open);

}  // namespace shvr
