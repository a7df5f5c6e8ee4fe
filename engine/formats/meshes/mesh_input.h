#pragma once
// A file of a mesh, read through a buffer: bytes, values of either byte order, lines and words. One thread.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/progress.h"
#include "engine/formats/meshes/mesh_memory.h"

namespace shvr {

class MeshInput {
public:
    /// The longest line and word, and the limit of `peek`.
    static constexpr size_t MAX_BUFFER_BYTES = size_t{1} << 20;

    /// Fails unless the path leads to a regular file. Reports the share of the file that was read.
    MeshInput(const std::filesystem::path& path, MeshMemory& memory, const Progress& progress);

    const std::string& name() const { return name_; }
    uint64_t size() const { return size_; }
    uint64_t position() const { return offset_ - (end_ - begin_); }
    uint64_t rest() const { return size_ - position(); }
    void seek(uint64_t position);

    /// The next bytes, without moving on: all of them unless the file ends earlier. Valid until the next call.
    std::string_view peek(size_t bytes);
    /// Fails if the file ends earlier.
    void read(std::span<char> bytes);
    void skip(uint64_t bytes);
    template <class Value>
    Value value(std::endian order = std::endian::little)
    {
        static_assert(std::endian::native == std::endian::little);
        std::array<char, sizeof(Value)> raw;
        read(raw);
        if (order == std::endian::big) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<Value>(raw);
    }

    /// The next line without its line end, LF or CR LF; null at the end of the file. Valid until the next call.
    std::optional<std::string_view> line();
    /// The next word between spaces and line ends; empty at the end of the file. Valid until the next call.
    std::string_view word();
    /// File and number of the last line, or of the last word's line: "scan.obj:12".
    std::string place() const { return name_ + ":" + std::to_string(line_); }

private:
    void fill(size_t wanted);
    std::string_view buffered() const { return {buffer_.data() + begin_, end_ - begin_}; }
    [[noreturn]] void fail_at_end() const;

    std::string name_;
    FileDescriptor file_;
    Progress progress_;
    uint64_t size_ = 0, offset_ = 0, read_ = 0;  ///< offset_: in the file, where the buffer ends
    std::vector<char> buffer_;
    size_t begin_ = 0, end_ = 0;
    uint64_t line_ = 0, line_ends_ = 0;
};

}  // namespace shvr
