#pragma once
// The targets of tests/fuzz in the replay program: CMake generates the table from their file names.

#include <cstddef>
#include <cstdint>
#include <span>

namespace shvr::fuzz {

struct Target {
    const char* name;
    int (*run)(const uint8_t* data, size_t size);
};
std::span<const Target> targets();

}  // namespace shvr::fuzz
