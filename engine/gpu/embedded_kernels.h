#pragma once
// The kernels compiled into the program, one for each shaders/NAME.comp. The build generates this table
// (tools/embed_kernels.cmake), so a new kernel needs no registration. Any thread may read the table.

#include <cstddef>
#include <cstdint>
#include <span>

namespace shvr::gpu {

struct EmbeddedKernel {
    const char* name;       ///< as in "raycast" for shaders/rays/raycast.comp
    const uint32_t* words;  ///< SPIR-V, including the names of variables
    size_t word_count;
};

/// Sorted by name.
std::span<const EmbeddedKernel> embedded_kernels();

}  // namespace shvr::gpu
