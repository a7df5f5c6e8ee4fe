#include "tools/golden/calibrate.h"

#include <algorithm>

#include "engine/base/image_file.h"

namespace shvr::golden {

namespace {

constexpr double MARGIN = 2.0;

std::filesystem::path picture_of(const std::filesystem::path& output, const Variant& variant, const Golden& golden)
{
    return output / variant.name / (golden.name + ".actual.png");
}

void widen(PixelDifference& most, const PixelDifference& other)
{
    most.max_abs = std::max(most.max_abs, other.max_abs);
    most.rmse = std::max(most.rmse, other.rmse);
    most.mean_error = std::max(most.mean_error, other.mean_error);
    most.fraction_over_1 = std::max(most.fraction_over_1, other.fraction_over_1);
    most.fraction_over_4 = std::max(most.fraction_over_4, other.fraction_over_4);
}

}  // namespace

const std::vector<Variant>& variants()
{
    static const std::vector<Variant> all{{"as-it-is", {}},
                                          {"without-fma", {{"GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1"}}},
                                          {"vectors-128", {{"LP_NATIVE_VECTOR_WIDTH", "128"}}},
                                          {"threads-0", {{"LP_NUM_THREADS", "0"}}},
                                          {"threads-1", {{"LP_NUM_THREADS", "1"}}},
                                          {"threads-7", {{"LP_NUM_THREADS", "7"}}},
                                          {"poisoned", {{"LVP_POISON_MEMORY", "1"}}}};
    return all;
}

bool allows_twice(const PixelDifference& most, Strictness strictness)
{
    if (strictness == Strictness::exact) return most.max_abs == 0.0;
    const PixelDifference twice{.max_abs = MARGIN * most.max_abs,
                                .rmse = MARGIN * most.rmse,
                                .psnr_db = {},
                                .mean_error = MARGIN * most.mean_error,
                                .fraction_over_1 = MARGIN * most.fraction_over_1,
                                .fraction_over_4 = MARGIN * most.fraction_over_4};
    if (strictness == Strictness::edge && twice.fraction_over_1 <= EDGE_FRACTION) return true;
    return !why_not_within(twice, TIGHT_TOLERANCE);
}

std::vector<Spread> calibrate(const std::vector<Golden>& goldens, const std::filesystem::path& output,
                              const DrawAll& draw_all)
{
    for (const Variant& variant : variants()) draw_all(variant, output / variant.name);
    std::vector<Spread> spreads;
    for (const Golden& golden : goldens) {
        Spread spread{.golden = golden, .by_variant = {}, .most = {}};
        const Image8 first = read_png(picture_of(output, variants().front(), golden));
        for (const Variant& variant : variants()) {
            const PixelDifference difference = compare_pixels(read_png(picture_of(output, variant, golden)), first);
            if (&variant != &variants().front()) spread.by_variant[variant.name] = difference;
            widen(spread.most, difference);
        }
        spread.holds = allows_twice(spread.most, golden.strictness);
        spread.could_be_exact = spread.most.max_abs == 0.0;
        spreads.push_back(std::move(spread));
    }
    return spreads;
}

}  // namespace shvr::golden
