// Names of compiled kernels: in the kernel's own order, whatever the order of the choices, and complete.

#include "engine/graph/kernel_variants.h"

#include <string>

#include <doctest/doctest.h>

#include "engine/graph/frame_graph.h"

using namespace shvr;

namespace {

constexpr std::string_view MACROS[] = {"PAGED", "MASKED"};
constexpr KernelVariants KNOWN[] = {{"cast", MACROS}};

std::string chosen(std::initializer_list<VariantChoice> choices, std::string_view kernel = "cast")
{
    return variant_of(kernel, choices, KNOWN);
}

}  // namespace

TEST_CASE("a variant's name follows the kernel's order, not that of the choices")
{
    CHECK(chosen({{"PAGED", false}, {"MASKED", false}}) == "cast");
    CHECK(chosen({{"MASKED", true}, {"PAGED", true}}) == "cast_paged_masked");
    CHECK(chosen({{"MASKED", true}, {"PAGED", false}}) == "cast_masked");
    CHECK(chosen({}, "other") == "other");
}

TEST_CASE("a variant that is unknown, missing or chosen twice is refused with those that there are")
{
    CHECK_THROWS_WITH(chosen({{"PAGED", true}, {"MASKED", true}, {"LISTED", true}}),
                      "variant LISTED of kernel 'cast' is unknown; it has PAGED MASKED");
    CHECK_THROWS_WITH(chosen({{"PAGED", true}}), "variant MASKED of kernel 'cast' is not chosen; it has PAGED MASKED");
    CHECK_THROWS_WITH(chosen({{"PAGED", true}, {"PAGED", true}, {"MASKED", true}}),
                      "variant PAGED of kernel 'cast' is chosen twice; it has PAGED MASKED");
    CHECK_THROWS_WITH(chosen({{"PAGED", true}}, "other"), "variant PAGED of kernel 'other' is unknown; it has none");
}

TEST_CASE("a graph refuses such a pass where it is declared, and takes the program's own kernels")
{
    FrameGraph graph;
    static_cast<void>(graph.compute("surfaces", {{"LISTED", true}}));
    CHECK(graph.passes()[0].kernel == "surfaces_listed");
    CHECK(graph.passes()[0].name == "surfaces");
    CHECK_THROWS_WITH(graph.compute("surfaces", {{"MASKED", true}}, "balls"),
                      doctest::Contains("pass 'balls' (kernel_variants_test.cpp:"));
}
