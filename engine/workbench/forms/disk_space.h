#pragma once
// Free space of a disk and what a task writes, in words. Pure; any thread.

#include <optional>
#include <string>

namespace shvr::ui {

/// Bytes that a task writes; 0: unknown.
struct BytesNeeded {
    double least = 0.0, most = 0.0;
};

struct SpaceWords {
    std::string refusal;  ///< the disk certainly has too little space
    std::string warning;  ///< it may have too little
};
/// Both texts are empty if the space suffices or `free_bytes` is unknown (null).
SpaceWords words_of_space(const BytesNeeded& needed, std::optional<double> free_bytes);

}  // namespace shvr::ui
