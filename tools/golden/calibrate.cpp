#include "tools/golden/calibrate.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "engine/base/image_file.h"
#include "tools/golden/light.h"

namespace shvr::golden {

namespace {

constexpr double MARGIN = 2.0;

struct Pictures {
    Image8 pixels;
    ImageF light;
};

Pictures pictures_of(const std::filesystem::path& output, const Variant& variant, const Golden& golden)
{
    const std::string start = (output / variant.name / golden.name).string();
    return {read_png(start + ".actual.png"), read_light(start + ".actual.pfm")};
}

std::string cell_of(const Moved& moved)
{
    if (moved.light == 0.0 && moved.pixels.max_abs == 0.0) return "0";
    std::ostringstream text;
    text << moved.pixels.max_abs << "; " << std::scientific << std::setprecision(1) << moved.light;
    return text.str();
}

void widen(PixelDifference& most, const PixelDifference& other)
{
    most.max_abs = std::max(most.max_abs, other.max_abs);
    most.rmse = std::max(most.rmse, other.rmse);
    most.alpha_rmse = std::max(most.alpha_rmse, other.alpha_rmse);
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
                                          {"vectors-512", {{"LP_NATIVE_VECTOR_WIDTH", "512"}}},
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
                                .alpha_rmse = MARGIN * most.alpha_rmse,
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
    const Outcome first_run = read_run(output / variants().front().name, "*");
    std::vector<Spread> spreads;
    for (const Golden& golden : goldens) {
        Spread spread{.golden = golden, .maker = {}, .by_variant = {}, .most = {}};
        for (const Result& result : first_run.results)
            if (result.golden.name == golden.name) spread.maker = result.maker;
        const Pictures first = pictures_of(output, variants().front(), golden);
        for (size_t i = 1; i < variants().size(); ++i) {
            const Pictures other = pictures_of(output, variants()[i], golden);
            const Moved moved{compare_pixels(other.pixels, first.pixels), largest_difference(other.light, first.light)};
            spread.by_variant[variants()[i].name] = moved;
            widen(spread.most.pixels, moved.pixels);
            spread.most.light = std::max(spread.most.light, moved.light);
        }
        spread.holds = allows_twice(spread.most.pixels, golden.strictness);
        spread.could_be_exact = spread.most.pixels.max_abs == 0.0;
        spreads.push_back(std::move(spread));
    }
    return spreads;
}

std::string table_of(const std::vector<Spread>& spreads, const std::string& command)
{
    std::string text = "# How far the driver alone moves each golden\n\nWritten by\n\n    " + command +
                       "\n\nEach golden is drawn with other vector widths, numbers of threads and instructions, and "
                       "with poisoned memory, and\ncompared with the picture of the driver as it is. *0*: the same "
                       "bits; otherwise the largest difference in levels of 255,\nand in linear light. *Holds*: the "
                       "class allows twice that.\n\n";
    if (!spreads.empty() && spreads.front().maker)
        text += sentence(spreads.front().maker->driver, " on ", spreads.front().maker->processor, " (",
                         spreads.front().maker->instructions, ").\n\n");
    text += "| golden | class | holds |";
    std::string rule = "|---|---|---|";
    for (size_t i = 1; i < variants().size(); ++i) {
        const Variant& variant = variants()[i];
        text += " " + variant.name + " |";
        rule += "---|";
    }
    text += "\n" + rule + "\n";
    for (const Spread& spread : spreads) {
        text += sentence("| ", spread.golden.name, " | ", spelled(spread.golden.strictness), " | ",
                         spread.holds ? "yes" : "no", " |");
        for (size_t i = 1; i < variants().size(); ++i)
            text += " " + cell_of(spread.by_variant.at(variants()[i].name)) + " |";
        text += "\n";
    }
    return text;
}

}  // namespace shvr::golden
