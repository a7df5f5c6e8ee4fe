// shvr compare: how much two pictures differ.

#include <iomanip>
#include <iostream>
#include <optional>

#include "engine/base/image_file.h"
#include "engine/base/image_metrics.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

constexpr double DIFFERENCE_GAIN = 16.0;

struct CompareCommandOptions {
    Common common;
    std::string a, b, difference;
    std::optional<double> max_abs, max_rmse;
};

Json to_json(const ImageDifference& difference, const Image8& image)
{
    return {{"size", {image.width, image.height}},
            {"max_abs", difference.max_abs},
            {"rmse", difference.rmse},
            {"alpha_rmse", difference.alpha_rmse},
            {"psnr_db", difference.psnr_db ? Json(*difference.psnr_db) : Json(nullptr)},
            {"ssim", difference.ssim},
            {"flip_mean", difference.flip_mean},
            {"flip_p99", difference.flip_p99},
            {"mean_error", difference.mean_error},
            {"fraction_over_1", difference.fraction_over_1},
            {"fraction_over_4", difference.fraction_over_4}};
}

template <class Value>
void print_line(const char* what, const Value& value, const char* unit)
{
    std::cout << std::left << std::setw(26) << what << value << unit << '\n';
}

void print_text(const ImageDifference& difference)
{
    print_line("largest difference", difference.max_abs, " of 255");
    print_line("root mean square", difference.rmse, " of 255");
    print_line("root mean square of alpha", difference.alpha_rmse, " of 255");
    if (difference.psnr_db)
        print_line("signal to noise (PSNR)", *difference.psnr_db, " dB");
    else
        print_line("signal to noise (PSNR)", "infinite: the colours are equal", "");
    print_line("similarity (SSIM)", difference.ssim, "");
    print_line("visible difference (FLIP)", difference.flip_mean,
               sentence(", 99 % below ", difference.flip_p99).c_str());
    print_line("pixels off by more than 1", 100.0 * difference.fraction_over_1, " %");
    print_line("pixels off by more than 4", 100.0 * difference.fraction_over_4, " %");
    std::cout.flush();
    if (!std::cout) fail("standard output: cannot be written");
}

void check_gates(const ImageDifference& difference, const CompareCommandOptions& options)
{
    if (options.max_abs && difference.max_abs > *options.max_abs)
        throw GateError(sentence(options.a, " and ", options.b, " differ by up to ", difference.max_abs,
                                 " levels; --max-abs allows ", *options.max_abs));
    if (options.max_rmse && difference.rmse > *options.max_rmse)
        throw GateError(sentence(options.a, " and ", options.b, " differ by ", difference.rmse,
                                 " levels root mean square; --max-rmse allows ", *options.max_rmse));
    if (options.max_rmse && difference.alpha_rmse > *options.max_rmse)
        throw GateError(sentence("alpha of ", options.a, " and ", options.b, " differs by ", difference.alpha_rmse,
                                 " levels root mean square; --max-rmse allows ", *options.max_rmse));
}

void run_compare(CompareCommandOptions options)
{
    check_output("--diff", options.difference, {".png"});
    if (!options.difference.empty()) options.difference = written_path(options.difference).string();
    for (const std::string& picture : {options.a, options.b}) check_output_is_not(picture, options.difference);
    LongWork work(options.common.quiet);
    static_cast<void>(work.begin("reading pictures"));
    const Image8 a = read_png(options.a);
    const Image8 b = read_png(options.b);
    if (a.width != b.width || a.height != b.height)
        fail(options.a, " has ", a.width, " x ", a.height, " pixels, ", options.b, " has ", b.width, " x ", b.height,
             "; expected the same size");
    const ImageDifference difference = compare(a, b, work.begin("comparing pictures"));
    if (!options.difference.empty()) static_cast<void>(work.begin("writing " + options.difference));
    if (!options.difference.empty()) write_png(options.difference, difference_picture(a, b, DIFFERENCE_GAIN));
    work.stop_if_asked();
    clear_progress();
    if (options.common.json)
        print(to_json(difference, a));
    else
        print_text(difference);
    check_gates(difference, options);
}

}  // namespace

void add_compare(CLI::App& program)
{
    auto options = std::make_shared<CompareCommandOptions>();
    CLI::App* command = program.add_subcommand("compare", "Measures the difference between two pictures");
    command->add_option("A", options->a, "Picture (.png)")->required();
    command->add_option("B", options->b, "Picture (.png) of the same size")->required();
    command->add_option("--diff", options->difference, "Picture to write (.png): the difference times 16");
    command->add_option("--max-abs", options->max_abs, "Exit 3 where a channel differs by more levels of 255")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--max-rmse", options->max_rmse,
                     "Exit 3 where the root mean square, of the colours or of alpha, is more levels of 255")
        ->check(CLI::NonNegativeNumber);
    add_output_options(*command, options->common);
    command->footer("Example:\n  shvr compare before.png after.png --diff difference.png --max-abs 2");
    command->callback([options] { run_compare(*options); });
}

}  // namespace shvr::cli
