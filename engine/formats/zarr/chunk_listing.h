#pragma once
// Which chunks of an array are stored, from the names in its folder: what is missing costs nothing. Any thread.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shvr {

/// Chunks are named PREFIX and a number for each axis of the array, with a separator between them; "/" makes folders.
struct ChunkNames {
    std::filesystem::path folder;
    std::string prefix{};
    char separator = '.';
    std::vector<int64_t> counts{};             ///< chunks along each axis
    std::vector<std::optional<int64_t>> at{};  ///< by axis: only chunks with this number; nothing: with any
};

/// Calls `take` with the numbers of each stored chunk, in no order. False, and stops, as soon as there are more than
/// `most`, or so many other names that going on would take much longer than `most` chunks should. Fails if a folder
/// cannot be listed; one that is missing holds nothing.
bool list_chunks(const ChunkNames& names, int64_t most,
                 const std::function<void(std::span<const int64_t> numbers)>& take);

/// A name among the first few in the folder that looks like a chunk's and is none of these: its numbers lie beyond
/// `counts`, or are not as many, or another separator is between them. Empty if there is none.
std::string stray_chunk(const ChunkNames& names);

}  // namespace shvr
