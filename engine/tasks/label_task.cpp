#include "engine/tasks/label_task.h"

#include <chrono>
#include <cmath>

#include "engine/base/atomic_writer.h"
#include "engine/base/text.h"
#include "engine/components/component_part.h"
#include "engine/formats/export/volume_export.h"
#include "engine/tasks/task_output.h"
#include "engine/tasks/task_parts.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int64_t MAX_FEWEST_VOXELS = int64_t{1} << 62, MAX_LARGEST = int64_t{1} << 32;

double seconds_since(Clock::time_point begin)
{
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string form_of(const fs::path& path)
{
    const fs::path plain = path.has_filename() ? path : path.parent_path();
    const bool is_in_project = plain.extension().empty() && plain.parent_path().filename() == "labels";
    return is_in_project ? ".zarr" : lower_case(plain.extension().string());
}

/// Returns the folder that must already exist: the parent of `path`, or the image above a parent called "labels".
fs::path folder_of(const fs::path& path)
{
    fs::path folder = fs::absolute(path).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    folder = folder.parent_path();
    std::error_code ignored;
    return folder.filename() == "labels" && !fs::exists(folder, ignored) ? folder.parent_path() : folder;
}

/// Writes labels as one byte per voxel, like a mask.
void write_mask(const LabelTask& task, const VolumeSource& labels, const Progress& progress)
{
    const VolumeInfo& info = labels.info();
    if (info.type != VoxelType::uint8)
        fail(task.output.string(), ": would hold labels of ", name_of(info.type),
             ", and a mask holds 255 at most; expected .zarr, .nrrd or .tif, or ", option_name(task.names, "largest"),
             " 255");
    AtomicWriter writer(task.output);
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

void write_labels(const LabelTask& task, const VolumeSource& labels, ProgressReporter& reporter)
{
    const Progress progress = reporter.begin("writing " + task.output.string());
    const std::string form = form_of(task.output);
    if (form == ".mask") return write_mask(task, labels, progress);
    if (form != ".zarr") return export_volume(task.output, labels, progress);
    const ImportOptions wanted{.threads = task.threads,
                               .version = task.version,
                               .progress = [&](const ImportProgress& done) { progress(done.fraction); },
                               .cancel = &reporter.stop_requested()};
    try {
        static_cast<void>(export_label_image(labels, task.output, {}, wanted));
    } catch (const ImportStopped& stopped) {
        throw Stopped(stopped.what());
    }
}

LabelTask resolved(LabelTask task)
{
    if (!task.output.empty()) task.output = written_path(task.output);
    return task;
}

ComponentOptions wanted_of(const LabelTask& task, const Progress& progress)
{
    ComponentOptions wanted{
        .threshold = task.threshold,
        .connectivity = task.connectivity,
        .fewest_voxels = task.fewest_voxels,
        .max_components = task.largest,
        .threads = task.threads,
        .progress = progress,
    };
    if (!task.output.empty()) wanted.run_folder = folder_of(task.output);
    return wanted;
}

/// Writes the labels, if they are wanted.
void write_result(const LabelTask& task, const Components& components, LabelResult& result, ProgressReporter& reporter)
{
    if (task.output.empty()) return;
    const std::unique_ptr<VolumeSource> labels = components.labels();
    result.type = labels->info().type;
    write_labels(task, *labels, reporter);
}

std::string warning_of(const std::string& name, const std::string& gaps)
{
    return sentence(name, ": ", gaps, " and count as below the threshold");
}

}  // namespace

void fields(Fields& f, LabelTask& task)
{
    f.number("threshold", task.threshold, INTENSITY,
             {.meaning = "voxels at or above it belong to components", .allowed = "the file's intensities"});
    int neighbours = int(task.connectivity);
    f.whole("connectivity", neighbours, 6, 26,
            {.meaning = "voxels are joined over faces, or over corners too", .allowed = "6 or 26"});
    f.check("connectivity", neighbours == 6 || neighbours == 26, "6 or 26");
    task.connectivity = neighbours == 26 ? Connectivity::corners : Connectivity::faces;
    f.whole("min_voxels", task.fewest_voxels, 1, MAX_FEWEST_VOXELS, {"smaller components are left out", "voxels"});
    f.whole("largest", task.largest, 0, MAX_LARGEST,
            {"only so many, the largest, are kept; of equal ones the first; 0: all"});
    f.path(
        "output", task.output,
        {.meaning = "the labels, from 1 in the order of first voxels: .zarr, .nrrd, .tif, .mask", .standard = "none"});
    version_field(f, task.version, "version of OME-Zarr; automatic: as the image or the labels there are, or 0.4");
    incomplete_field(f, task.allows_incomplete, "voxels that cannot be read are as low as their type allows");
    threads_field(f, task.threads);
}

std::vector<fs::path> replaced_files(const LabelTask& task)
{
    std::error_code ignored;
    if (task.output.empty() || !fs::exists(task.output, ignored)) return {};
    return {task.output};
}

void check(const LabelTask& task)
{
    const auto name = [&](const char* key) { return option_name(task.names, key); };
    if (std::isnan(task.threshold)) throw UsageError(name("threshold") + " is no number; expected an intensity");
    if (task.fewest_voxels < 1 || task.fewest_voxels > MAX_FEWEST_VOXELS)
        throw UsageError(
            sentence(name("min_voxels"), " is ", task.fewest_voxels, "; expected 1 to ", MAX_FEWEST_VOXELS));
    if (task.largest < 0 || task.largest > MAX_LARGEST)
        throw UsageError(sentence(name("largest"), " is ", task.largest, "; expected 0 to ", MAX_LARGEST));
    check_threads(task.threads, task.names);
    const std::string form = form_of(task.output);
    if (!task.output.empty() && form != ".zarr" && form != ".mask" && !is_volume_export(task.output))
        throw UsageError(sentence(name("output"), " is '", task.output.string(),
                                  "'; expected a name that ends in one of: .zarr, .nrrd, .tif, .tiff, .mask, or "
                                  "PROJECT/labels/NAME"));
    if (form == ".zarr")
        check_output_folder(task.output);
    else if (!task.output.empty())
        check_output_place(task.output);
}

void check(const LabelTask& task, const VolumeSource& source, const fs::path& volume)
{
    // A sparse volume can have more voxels than fit into a file of a dense format.
    constexpr int64_t MAX_VOXELS_WRITTEN = int64_t{1} << 44;
    check(task);
    check_output_is_not(volume, task.output);
    const VolumeInfo& info = source.info();
    if (task.output.empty() || voxel_count(info) <= MAX_VOXELS_WRITTEN) return;
    const std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
    const bool is_sparse = stored && !(stored->fill >= task.threshold);
    if (is_sparse && form_of(task.output) == ".zarr") return;
    fail(task.output.string(), ": would hold the labels of ", voxel_count(info), " voxels; expected at most ",
         MAX_VOXELS_WRITTEN, is_sparse ? ", or .zarr, which holds what is stored alone" : "", ": leave out ",
         option_name(task.names, "output"), ", or label a part of the volume");
}

LabelResult run(const LabelTask& asked, const VolumeSource& source, const std::string& name, ProgressReporter& reporter)
{
    check(asked, source, {});
    const LabelTask task = resolved(asked);
    const Clock::time_point begin = Clock::now();
    Gaps gaps = gaps_of(task.allows_incomplete, task.names);
    const std::unique_ptr<Components> components =
        find_components(GapSource(source, gaps), wanted_of(task, reporter.begin("labelling " + name)));
    LabelResult result{.counts = components->counts(), .label_seconds = seconds_since(begin)};
    write_result(task, *components, result, reporter);
    result.voxels_not_read = gaps.voxels();
    if (!gaps.empty()) result.warnings.push_back(warning_of(name, gaps.in_words()));
    result.seconds = seconds_since(begin);
    return result;
}

void run_part(const LabelTask& asked, const VolumeSource& source, const std::string& name, const TaskChoice& choice,
              const fs::path& piece, ProgressReporter& reporter)
{
    check(asked, source, {});
    const LabelTask task = resolved(asked);
    Gaps gaps = gaps_of(task.allows_incomplete, task.names);
    ComponentOptions wanted = wanted_of(task, reporter.begin("labelling " + name + ", part " + choice.in_words()));
    if (wanted.run_folder) wanted.run_folder = piece.parent_path();
    const Size3& size = source.info().size;
    const int64_t block = std::clamp<int64_t>(source.block().z, 1, size.z);
    const TaskChoice::Range blocks = choice.range_of((size.z + block - 1) / block);
    write_component_part(GapSource(source, gaps), wanted,
                         {std::min(blocks.lower * block, size.z), std::min(blocks.upper * block, size.z)}, piece,
                         [&] { return gaps.empty() ? "" : sentence(gaps.voxels(), ' ', gaps.in_words()); });
}

LabelResult join_parts(const LabelTask& asked, const VolumeSource& source, const std::string& name,
                       const std::vector<fs::path>& pieces, ProgressReporter& reporter)
{
    check(asked, source, {});
    const LabelTask task = resolved(asked);
    const Clock::time_point begin = Clock::now();
    const Progress progress = reporter.begin("joining the parts of " + name);
    std::vector<ComponentPart> parts;
    for (const fs::path& piece : pieces) {
        tell(progress, double(parts.size()) / double(pieces.size()));
        parts.emplace_back(piece, source.info().size);
    }
    const std::unique_ptr<Components> components = join_components(source, wanted_of(task, progress), parts);
    LabelResult result{.counts = components->counts(), .label_seconds = seconds_since(begin)};
    write_result(task, *components, result, reporter);
    for (const ComponentPart& part : parts) {
        const std::string& note = part.note();  // "VOXELS WORDS"
        const size_t space = std::min(note.find(' '), note.size());
        if (note.empty()) continue;
        result.voxels_not_read += whole_of(std::string_view(note).substr(0, space)).value_or(0);
        result.warnings.push_back(warning_of(name, note.substr(std::min(space + 1, note.size()))));
    }
    result.seconds = seconds_since(begin);
    return result;
}

}  // namespace shvr
