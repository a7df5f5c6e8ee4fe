#pragma once
// The macros with which a kernel may be compiled, from the line "// variants: A B" of shaders/NAME.comp. The build
// (tools/embed_kernels.cmake) generates this table and compiles every subset of the macros, so their order is stated in
// that line alone. Any thread.

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace shvr {

/// The name of a compiled kernel, and the specialization constants in the order in which the pass sets them.
using KernelVariant = std::pair<std::string, std::vector<std::pair<std::string, uint32_t>>>;

/// A macro of a kernel, and its value.
struct VariantChoice {
    std::string_view macro;
    bool is_on = false;
};

struct KernelVariants {
    std::string_view kernel;                   ///< as in "raycast" for shaders/rays/raycast.comp
    std::span<const std::string_view> macros;  ///< the macros in the kernel's order; empty if there are none
};
/// Returns the tables of all kernels that have variants.
std::span<const KernelVariants> kernel_variants();

/// Returns the name of a compiled kernel: "raycast" with PAGED and MASKED is "raycast_paged_masked". `choices` must
/// name each macro of the kernel once, in any order; otherwise this fails, with a message that lists the macros.
std::string variant_of(std::string_view kernel, std::initializer_list<VariantChoice> choices);
/// Likewise, but takes the table from `known`.
std::string variant_of(std::string_view kernel, std::initializer_list<VariantChoice> choices,
                       std::span<const KernelVariants> known);

}  // namespace shvr
