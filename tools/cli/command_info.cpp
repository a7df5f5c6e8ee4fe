// shvr info: describes a volume, a session or a project. Needs no Vulkan device.

#include <iomanip>
#include <iostream>

#include "engine/base/text.h"
#include "engine/tasks/describe_task.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct InfoCommandOptions {
    Common common;
    std::string input;
    bool exact = false;
    bool allows_incomplete = false;
};

Json fill_values(const VolumeStatistics& statistics)
{
    Json all = Json::array();
    for (const ValueCount& fill : statistics.fill) all.push_back({{"value", fill.value}, {"voxels", fill.voxels}});
    return all;
}

/// How the statistics were obtained.
std::string measured_text(const VolumeStatistics& statistics)
{
    if (statistics.sampled_voxels > 0) return sentence("sample of ", statistics.sampled_voxels, " voxels");
    return statistics.measured_level > 0 ? sentence("level ", statistics.measured_level) : "exact";
}

Json to_json(const DescribeResult& described, const std::string& input)
{
    const VolumeInfo& info = described.info;
    const VolumeStatistics& statistics = described.statistics;
    const IntensityWindow window = window_for(info.type, statistics);
    const int64_t voxels = voxel_count(info);
    Json directions = Json::array();  // for x, for y, for z
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3& direction = info.directions[axis];
        directions.push_back({direction.x, direction.y, direction.z});
    }
    return {{"input", input},
            {"name", info.name},
            {"format", info.format},
            {"size", {info.size.x, info.size.y, info.size.z}},
            {"type", name_of(info.type)},
            {"spacing", {info.spacing.x, info.spacing.y, info.spacing.z}},
            {"unit", info.unit},
            {"spacing_from", name_of(info.spacing_from)},
            {"unit_from", name_of(info.unit_from)},
            {"frame", info.frame},
            {"directions", directions},
            {"origin", {info.origin.x, info.origin.y, info.origin.z}},
            {"min", statistics.minimum},
            {"max", statistics.maximum},
            {"mean", statistics.mean},
            {"statistics", measured_text(statistics)},
            {"measured_level", statistics.measured_level},
            {"voxels", voxels},
            {"voxels_not_finite", statistics.not_finite},
            {"fill_values", fill_values(statistics)},
            {"voxels_not_read", described.voxels_not_read},
            {"complete", described.voxels_not_read == 0},
            {"bytes", uint64_t(voxels) * bytes_of(info.type)},
            {"levels", described.levels},
            {"histogram", statistics.histogram},
            {"window", {{"lower", window.lower}, {"upper", window.upper()}, {"codes_per_unit", window.codes_per_unit}}},
            {"mask", described.mask.empty() ? Json(nullptr) : Json(described.mask.string())},
            {"warnings", described.warnings}};
}

/// Returns a number with its digits in groups of three: "1 024 000".
std::string grouped(int64_t number)
{
    std::string digits = std::to_string(number);
    for (int at = int(digits.size()) - 3; at > 0; at -= 3) digits.insert(size_t(at), " ");
    return digits;
}

std::string bytes_text(uint64_t bytes)
{
    const double mebibytes = double(bytes) / double(1 << 20);
    return sentence(std::fixed, std::setprecision(mebibytes < 10 ? 1 : 0), mebibytes, " MiB");
}

std::string plural(const std::string& unit)
{
    return unit == "voxel" ? "voxels" : unit;
}

void print_line(const char* what, const std::string& value)
{
    std::cout << std::left << std::setw(14) << what << printable(value) << '\n';
}

void print_text(const DescribeResult& described)
{
    const VolumeInfo& info = described.info;
    const VolumeStatistics& statistics = described.statistics;
    const glm::dvec3 extent = glm::dvec3(info.size) * info.spacing;
    const int64_t voxels = voxel_count(info);
    const char* const from = info.spacing_from == Provenance::given     ? " (given)"
                             : info.spacing_from == Provenance::assumed ? " (assumed)"
                                                                        : "";
    print_line("name", info.name);
    print_line("format", info.format);
    print_line("size",
               sentence(info.size.x, " x ", info.size.y, " x ", info.size.z, " voxels (", grouped(voxels), ")"));
    print_line("one voxel",
               sentence(info.spacing.x, " x ", info.spacing.y, " x ", info.spacing.z, " ", info.unit, from));
    print_line("whole volume", sentence(extent.x, " x ", extent.y, " x ", extent.z, " ", plural(info.unit)));
    print_line("voxel type", sentence(name_of(info.type), ", ", bytes_text(uint64_t(voxels) * bytes_of(info.type))));
    const std::string how = measured_text(statistics);
    print_line("intensities", sentence(statistics.minimum, " to ", statistics.maximum, ", mean ", statistics.mean,
                                       how == "exact" ? "" : " (" + how + ")"));
    for (const ValueCount& fill : statistics.fill)
        print_line("fill value", sentence(digits_of(fill.value), " in ", grouped(fill.voxels), " voxels"));
    if (described.levels > 1) print_line("levels", sentence(described.levels, ", each half as fine as the one before"));
    if (!described.mask.empty()) print_line("mask", described.mask.string());
    std::cout.flush();
    if (!std::cout) fail("standard output: cannot be written");
}

void run_info(const InfoCommandOptions& options)
{
    LongWork work(options.common.quiet);
    const DescribeResult described = run(DescribeTask{.input = options.input,
                                                      .exact = options.exact,
                                                      .allows_incomplete = options.allows_incomplete,
                                                      .settings = options.common.settings,
                                                      .names = OptionNames::command_line},
                                         work);
    warn_of_losses(described.losses);
    clear_progress();
    warn(described.warnings, options.common);
    if (options.common.json)
        print(to_json(described, options.input));
    else
        print_text(described);
}

}  // namespace

void add_info(CLI::App& program)
{
    auto options = std::make_shared<InfoCommandOptions>();
    CLI::App* command = program.add_subcommand("info", "Describes a volume, a session or a project");
    command->add_option("INPUT", options->input, "Volume, session (.json) or project folder")->required();
    command->add_flag("--exact", options->exact,
                      "Go through all voxels, also of volumes so large that a sample or a coarser level would do");
    add_incomplete_option(*command, options->allows_incomplete,
                          "Leave out voxels that cannot be read, with a warning, instead of failing");
    add_input_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer("Example:\n  shvr info scan.nhdr --json");
    command->callback([options] { run_info(*options); });
}

}  // namespace shvr::cli
