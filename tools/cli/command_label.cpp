// shvr label: connected components of a whole volume, which need not fit into memory. Needs no device.

#include <chrono>
#include <cmath>

#include "engine/annotation/work/work_offsets.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/text.h"
#include "engine/components/components.h"
#include "engine/formats/export/volume_export.h"
#include "engine/projects/import_volume.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

using Clock = std::chrono::steady_clock;

struct LabelCommandOptions {
    Common common;
    std::string volume, output;
    std::optional<OmeZarrVersion> version;
    double threshold = 0.0;
    int connectivity = 6;
    int64_t fewest_voxels = 1, largest = 0;
};

double seconds_since(Clock::time_point begin)
{
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string form_of(const std::filesystem::path& path)
{
    const std::filesystem::path plain = path.has_filename() ? path : path.parent_path();
    const bool is_in_project = plain.extension().empty() && plain.parent_path().filename() == "labels";
    return is_in_project ? ".zarr" : lower_case(plain.extension().string());
}

/// The folder of an output; a project's "labels" may not exist yet.
std::filesystem::path folder_of(const std::filesystem::path& path)
{
    std::filesystem::path folder = std::filesystem::absolute(path).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    folder = folder.parent_path();
    std::error_code ignored;
    return folder.filename() == "labels" && !std::filesystem::exists(folder, ignored) ? folder.parent_path() : folder;
}

void check_usage(const LabelCommandOptions& options)
{
    if (std::isnan(options.threshold)) throw UsageError("--threshold is no number; expected an intensity");
    const std::string form = form_of(options.output);
    if (!options.output.empty() && form != ".zarr" && form != ".mask" && !is_volume_export(options.output))
        throw UsageError(sentence("--output is '", options.output,
                                  "'; expected a name that ends in one of: .zarr, .nrrd, .tif, .tiff, .mask, or "
                                  "PROJECT/labels/NAME"));
}

/// Of a sparse volume more can be labelled than anybody can write.
void check_output_size(const LabelCommandOptions& options, const VolumeInfo& info)
{
    constexpr int64_t MAX_VOXELS_WRITTEN = int64_t{1} << 44;
    if (options.output.empty() || voxel_count(info) <= MAX_VOXELS_WRITTEN) return;
    fail(options.output, ": would hold the labels of ", voxel_count(info), " voxels; expected at most ",
         MAX_VOXELS_WRITTEN, ": leave out --output, or label a part of the volume");
}

/// One byte per voxel, as in masks.
void write_mask(const std::string& path, const VolumeSource& labels, const Progress& progress)
{
    const VolumeInfo& info = labels.info();
    if (info.type != VoxelType::uint8)
        fail(path, ": would hold labels of ", name_of(info.type),
             ", and a mask holds 255 at most; expected .zarr, .nrrd ", "or .tif, or --largest 255");
    AtomicWriter writer(path);
    std::vector<std::byte> rows;
    const int64_t step = export_rows(info);
    for (int64_t z = 0; z < info.size.z; ++z)
        for (int64_t y = 0; y < info.size.y; y += step) {
            tell(progress, (double(z) + double(y) / double(info.size.y)) / double(info.size.z));
            const VoxelBox box{{0, y, z}, {info.size.x, std::min(y + step, info.size.y), z + 1}};
            rows.resize(size_t(box.size().x * box.size().y));
            labels.read(box, rows);
            writer.append(rows);
        }
    writer.commit();
}

void write_labels(const LabelCommandOptions& options, const VolumeSource& labels, const Progress& progress)
{
    const std::string form = form_of(options.output);
    if (form == ".mask") return write_mask(options.output, labels, progress);
    if (form != ".zarr") return export_volume(options.output, labels, progress);
    const ImportOptions wanted{.threads = options.common.threads,
                               .version = options.version,
                               .progress = [&](const ImportProgress& done) { progress(done.fraction); },
                               .cancel = &LongWork::stop_requested()};
    static_cast<void>(export_label_image(labels, options.output, {}, wanted));
}

void run_label(const LabelCommandOptions& options)
{
    check_usage(options);
    LongWork work(options.common.quiet);
    const UnmeasuredSession opened = open_unmeasured_session(options.volume, options.common.settings);
    const VolumeInfo info = opened.source->info();
    check_output_size(options, info);
    warn(info.warnings, options.common);
    warn_of_losses(opened.losses);
    warn_of_holder(opened.session.journal_path, options.common);
    std::vector<Notice> notices;
    const DensityField offsets = offsets_of(work_files(opened.session, info), options.common.belief, notices);
    warn(notices, options.common);
    const std::shared_ptr<const VolumeSource> source = with_offsets(opened.source, offsets);
    const auto begin = Clock::now();
    ComponentOptions wanted{
        .threshold = options.threshold,
        .connectivity = options.connectivity == 6 ? Connectivity::faces : Connectivity::corners,
        .fewest_voxels = options.fewest_voxels,
        .max_components = options.largest,
        .threads = options.common.threads,
        .progress = work.begin("labelling " + options.volume),
    };
    if (!options.output.empty()) wanted.run_folder = folder_of(options.output);
    const std::unique_ptr<Components> components = find_components(*source, wanted);
    const double label_seconds = seconds_since(begin);
    const Components::Counts& counts = components->counts();
    Json type = nullptr;
    if (!options.output.empty()) {
        const std::unique_ptr<VolumeSource> labels = components->labels();
        type = name_of(labels->info().type);
        write_labels(options, *labels, work.begin("writing " + options.output));
    }
    const double seconds = seconds_since(begin);
    const auto voxels = double(voxel_count(info));
    if (!options.common.json) {
        say(options.common,
            sentence(counts.found, " components of ", counts.foreground_voxels, " voxels, the largest of ",
                     counts.largest_voxels, "; kept ", counts.kept, " of ", counts.kept_voxels, "; ", seconds, " s"));
        return;
    }
    Json largest = Json::array();
    for (const Components::Component& component : counts.largest)
        largest.push_back({{"label", component.label}, {"voxels", component.voxels}});
    print({{"components", counts.found},
           {"foreground_voxels", counts.foreground_voxels},
           {"largest_voxels", counts.largest_voxels},
           {"seconds", seconds},
           {"label_seconds", label_seconds},
           {"megavoxels_per_second", voxels / label_seconds / 1e6},
           {"kept", counts.kept},
           {"kept_voxels", counts.kept_voxels},
           {"largest", largest},
           {"size", {info.size.x, info.size.y, info.size.z}},
           {"threshold", options.threshold},
           {"connectivity", options.connectivity},
           {"output", options.output.empty() ? Json(nullptr) : Json(options.output)},
           {"type", type},
           {"peak_bytes", counts.peak_bytes},
           {"provisional_labels", counts.provisional},
           {"run_file_bytes", counts.run_file_bytes},
           {"voxels_with_offset", offsets.voxels()},
           {"warnings", info.warnings}});
}

}  // namespace

void add_label(CLI::App& program)
{
    auto options = std::make_shared<LabelCommandOptions>();
    CLI::App* command = program.add_subcommand("label", "Finds the connected components of a whole volume");
    command->add_option("VOLUME", options->volume, "Volume, project folder or session (.json)")->required();
    command->add_option("--threshold", options->threshold, "Voxels at or above it belong to components")->required();
    command->add_option("--connectivity", options->connectivity, "Voxels are joined over faces, or over corners too")
        ->check(CLI::IsMember({6, 26}));
    command->add_option("--min-voxels", options->fewest_voxels, "Leave out smaller components")
        ->check(CLI::Range(int64_t{1}, int64_t{1} << 62));
    command->add_option("--largest", options->largest, "Keep only the N largest; of equal ones the first")
        ->type_name("N")
        ->check(CLI::Range(int64_t{1}, int64_t{1} << 32));
    command->add_option("-o,--output", options->output,
                        "The labels, from 1 in the order of first voxels (.zarr: OME-Zarr labels; .nrrd, .tif; .mask)");
    add_version_option(*command, options->version, "unless given, as the image or the labels there are, or 0.4");
    command->add_option("--threads", options->common.threads, "Worker threads; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_belief_option(*command, options->common);
    add_input_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Density offsets of a session or project are added to its voxels. Memory follows the size of a slice and the "
        "number of components.\n"
        "Example:\n  shvr label scan/ --threshold 120 --min-voxels 50 -o scan/labels/parts --json");
    command->callback([options] { run_label(*options); });
}

}  // namespace shvr::cli
