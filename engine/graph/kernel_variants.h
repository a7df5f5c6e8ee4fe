#pragma once
// Which macros a kernel may be compiled with: those of its line "// variants: A B" in shaders/NAME.comp. The build
// writes the table (tools/embed_kernels.cmake) and compiles every subset, so that no order is known twice. Any thread.

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace shvr {

/// A macro of a kernel, and whether it is wanted.
struct VariantChoice {
    std::string_view macro;
    bool is_on = false;
};

struct KernelVariants {
    std::string_view kernel;                   ///< "raycast" for shaders/raycast.comp
    std::span<const std::string_view> macros;  ///< in the kernel's order; empty where it has no variants
};
/// Of all kernels that have any.
std::span<const KernelVariants> kernel_variants();

/// The name of the compiled kernel: "raycast" with PAGED and MASKED is "raycast_paged_masked". `choices` names each
/// macro of the kernel once, in any order; otherwise it fails and says which the kernel has.
std::string variant_of(std::string_view kernel, std::initializer_list<VariantChoice> choices);
/// The same with a table of one's own.
std::string variant_of(std::string_view kernel, std::initializer_list<VariantChoice> choices,
                       std::span<const KernelVariants> known);

}  // namespace shvr
