#pragma once
// The kernels compiled into the program, one for each shaders/NAME.comp. The build generates the table
// (tools/embed_kernels.cmake), so a new kernel needs no registration. Any thread may read it.

#include <cstddef>
#include <cstdint>
#include <span>

namespace shvr::gpu {

struct EmbeddedKernel {
    const char* name;       ///< "raycast" for shaders/rays/raycast.comp
    const uint32_t* words;  ///< SPIR-V, names of variables included
    size_t word_count;
};

/// Sorted by name.
std::span<const EmbeddedKernel> embedded_kernels();

}  // namespace shvr::gpu
