#pragma once
// The targets of tests/fuzz that the replay program holds: CMake makes the table from the names of their files.

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
