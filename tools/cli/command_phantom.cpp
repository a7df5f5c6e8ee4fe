// shvr phantom: writes files of a synthetic volume and, if known, of its ground truth. Needs no Vulkan device.

#include <algorithm>
#include <bit>
#include <cstdio>

#include "engine/annotation/trace/trace_edit.h"
#include "engine/annotation/trace/trace_file.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/text.h"
#include "engine/study/scene.h"
#include "engine/volume/grid.h"
#include "engine/volume/phantoms/phantom.h"
#include "engine/volume/voxel_walk.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

/// Maximum size of the slabs in which voxels are computed and written; a slab has at least one row.
constexpr int64_t SLAB_BYTES = int64_t{32} << 20;

struct PhantomCommandOptions {
    Common common;
    std::string folder;
    std::string size = "64";
    std::string type = "uint8";
    std::string hand = "right";
    PhantomSpec spec;
    std::vector<const CLI::Option*> of_capitulum, of_flaws;  ///< options that other kinds of phantoms refuse
    const CLI::Option* double_tubes = nullptr;
    std::vector<std::pair<const CLI::Option*, double PhantomFlaws::*>> flaws;
};

/// "64" or "64x32x16"
Size3 parse_volume_size(const std::string& text)
{
    glm::ivec3 size{0};
    char end = 0;
    const int numbers = std::sscanf(text.c_str(), "%7dx%7dx%7d%c", &size.x, &size.y, &size.z, &end);
    if (numbers == 1 && text.find_first_not_of("0123456789") == std::string::npos) size = glm::ivec3(size.x);
    if ((numbers != 1 && numbers != 3) || glm::any(glm::lessThan(size, glm::ivec3(1))) ||
        glm::any(glm::greaterThan(size, glm::ivec3(int{MAX_SIDE}))))
        throw UsageError(
            sentence("--size is ", in_quotes(text), "; expected N or WIDTHxHEIGHTxDEPTH, each from 1 to ", MAX_SIDE));
    return size;
}

std::string nrrd_header(const VolumeInfo& info, const std::string& voxels)
{
    const char* type = info.type == VoxelType::float32   ? "float"
                       : info.type == VoxelType::float64 ? "double"
                                                         : name_of(info.type);
    const char* endian = std::endian::native == std::endian::little ? "little" : "big";
    return sentence("NRRD0004\ntype: ", type, "\ndimension: 3\nsizes: ", info.size.x, " ", info.size.y, " ",
                    info.size.z,
                    "\nspacings: 1 1 1\nunits: \"voxel\" \"voxel\" \"voxel\"\nencoding: raw\nendian: ", endian,
                    "\ndata file: ", voxels, "\n");
}

void write_voxels(const std::filesystem::path& path, const VolumeSource& volume, const Progress& progress)
{
    const ToldSource source(volume, progress);
    const Size3 size = source.info().size;
    const int64_t row_bytes = size.x * int64_t(bytes_of(source.info().type));
    const int64_t rows = std::clamp<int64_t>(SLAB_BYTES / row_bytes, 1, size.y);
    const int64_t slices = rows < size.y ? 1 : std::clamp<int64_t>(SLAB_BYTES / (row_bytes * rows), 1, size.z);
    std::vector<std::byte> slab(size_t(row_bytes * rows * slices));
    AtomicWriter writer(path);
    for (int64_t z = 0; z < size.z; z += slices)
        for (int64_t y = 0; y < size.y; y += rows) {
            const VoxelBox box{{0, y, z}, {size.x, std::min(y + rows, size.y), std::min(z + slices, size.z)}};
            const std::span<std::byte> voxels = std::span(slab).first(size_t(row_bytes * box.size().y * box.size().z));
            source.read(box, voxels);
            writer.append(voxels);
        }
    writer.commit();
}

/// Writes FOLDER/NAME.nhdr and NAME.raw. Opens the header first, so that an unwritable name fails before the long work,
/// and commits it last, so that a header never describes voxels that are not written yet.
std::string write_volume(const std::filesystem::path& folder, const std::string& name, const VolumeSource& volume,
                         LongWork& work)
{
    const std::filesystem::path header = folder / (name + ".nhdr"), voxels = folder / (name + ".raw");
    const std::string text = nrrd_header(volume.info(), voxels.filename().string());
    AtomicWriter header_writer(header);
    header_writer.append(std::as_bytes(std::span(text)));
    write_voxels(voxels, volume, work.begin("writing " + voxels.string()));
    header_writer.commit();
    return header.string();
}

/// Refuses options that this kind of phantom ignores, so that users notice that their phantom lacks the property.
void check_use(const PhantomCommandOptions& options)
{
    const std::string& kind = options.spec.kind;
    const auto refuse = [&](const std::vector<const CLI::Option*>& unused, const char* of) {
        for (const CLI::Option* option : unused)
            if (option->count() > 0)
                throw UsageError(sentence(option->get_name(), " does not apply to ", kind, "; it is for ", of));
    };
    if (!has_flaws(kind)) refuse(options.of_flaws, "models of plants, such as capitulum");
    if (!has_double_tubes(kind)) refuse({options.double_tubes}, "capitulum, section and stem");
    if (kind != "capitulum") refuse(options.of_capitulum, "capitulum");
}

void run_phantom(const PhantomCommandOptions& options)
{
    const std::optional<VoxelType> type = voxel_type_of(options.type);
    if (!type)
        throw UsageError(sentence("--type is ", in_quotes(options.type), "; expected a voxel type, such as uint8"));
    check_use(options);
    PhantomSpec spec = options.spec;
    spec.size = parse_volume_size(options.size);
    spec.type = *type;
    spec.left_handed = options.hand == "left";
    const PhantomFlaws usual = usual_flaws(spec.kind);
    for (const auto& [option, flaw] : options.flaws)
        if (option->count() == 0) spec.flaws.*flaw = usual.*flaw;
    const Phantom phantom = make_phantom(spec);
    const VolumeInfo& info = phantom.volume->info();

    LongWork work(options.common.quiet);
    const std::filesystem::path folder = options.folder;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) fail(options.folder, ": cannot be created: ", error.message());
    Json written = {{"volume", write_volume(folder, spec.kind, *phantom.volume, work)},
                    {"truth_mask", nullptr},
                    {"truth_partial_mask", nullptr},
                    {"truth_tissue_mask", nullptr},
                    {"truth_trace", nullptr}};
    if (phantom.mask) written["truth_mask"] = write_volume(folder, spec.kind + "-mask", *phantom.mask, work);
    if (phantom.partial_mask)
        written["truth_partial_mask"] = write_volume(folder, spec.kind + "-partial-mask", *phantom.partial_mask, work);
    if (phantom.tissue_mask)
        written["truth_tissue_mask"] = write_volume(folder, spec.kind + "-tissue-mask", *phantom.tissue_mask, work);
    if (!phantom.nodes.empty()) {
        const std::filesystem::path trace = folder / (spec.kind + "-trace.graphml");
        save_trace(trace, trace_of(phantom, info.spacing), space_of(info));
        written["truth_trace"] = trace.string();
    }

    if (!options.common.json) {
        for (const Json& path : written)
            if (path.is_string()) say(options.common, path.get<std::string>());
        return;
    }
    print({{"volume", written["volume"]},
           {"truth_mask", written["truth_mask"]},
           {"truth_partial_mask", written["truth_partial_mask"]},
           {"truth_tissue_mask", written["truth_tissue_mask"]},
           {"truth_trace", written["truth_trace"]},
           {"sections", phantom.sections},
           {"tissues", phantom.tissues},
           {"facts", phantom.facts},
           {"size", {info.size.x, info.size.y, info.size.z}},
           {"type", name_of(*type)},
           {"kind", spec.kind},
           {"seed", spec.seed}});
}

std::vector<std::string> type_names()
{
    std::vector<std::string> names;
    for (const VoxelType type : VOXEL_TYPES) names.emplace_back(name_of(type));
    return names;
}

void add_capitulum_options(CLI::App& command, PhantomCommandOptions& options)
{
    PhantomSpec& spec = options.spec;
    const auto add = [&](CLI::Option* option) {
        options.of_capitulum.push_back(option->group("Flower heads (capitulum)")->capture_default_str());
        return option;
    };
    add(command.add_option("--species", spec.species, "Course of adaxial veins and shape of the head"))
        ->check(CLI::IsMember(capitulum_species()));
    add(command.add_option("--stage", spec.stage, "Of development, from a, only abaxial veins, to d, all joined"))
        ->check(CLI::IsMember({"a", "b", "c", "d"}));
    add(command.add_option("--phyllotaxis", spec.phyllotaxis, "Arrangement of the florets"))
        ->check(CLI::IsMember({"fibonacci", "lucas", "bijugate"}));
    add(command.add_option("--hand", options.hand, "left: successive florets turn clockwise, seen from above"))
        ->check(CLI::IsMember({"left", "right"}));
    add(command.add_option("--florets", spec.florets, "Number of florets"))->check(CLI::Range(8, 1000));
    options.double_tubes = command.add_flag("--double-tubes", spec.double_tubes,
                                            "Phloem next to each bundle's xylem, which is traced (capitulum, section, "
                                            "stem)");
}

void add_flaw_options(CLI::App& command, PhantomCommandOptions& options)
{
    const char* group = "Flaws of models of plants; percent, of the contrast of veins unless stated";
    const auto add = [&](const char* name, double PhantomFlaws::*flaw, double least, double most, const char* meaning) {
        const CLI::Option* option = command.add_option(name, options.spec.flaws.*flaw, meaning)
                                        ->group(group)
                                        ->check(number_between(least, most))
                                        ->capture_default_str();
        options.of_flaws.push_back(option);
        options.flaws.emplace_back(option, flaw);
    };
    add("--noise", &PhantomFlaws::noise, 0.0, 100.0, "Standard deviation of noise (roots: 5)");
    add("--rings", &PhantomFlaws::rings, 0.0, 100.0, "Height of rings around the axis z");
    add("--streaks", &PhantomFlaws::streaks, 0.0, 100.0, "Height of straight streaks in slices");
    add("--specks", &PhantomFlaws::specks, 0.0, 4.0, "Voxels, of all, in bright specks");
    add("--gaps", &PhantomFlaws::gaps, 0.0, 100.0,
        "Pieces of veins, of all, with a gap, which the truth bridges (roots: 15)");
    add("--falling", &PhantomFlaws::falling, 0.0, 100.0, "Intensity missing on the axis z");
    add("--uneven", &PhantomFlaws::uneven, 0.0, 100.0, "Intensity that comes and goes at most, of itself, smoothly");
    add("--blur", &PhantomFlaws::blur, 0.01, 16.0, "Voxels over which surfaces are soft");
}

}  // namespace

void add_phantom(CLI::App& program)
{
    auto options = std::make_shared<PhantomCommandOptions>();
    CLI::App* command = program.add_subcommand(
        "phantom", "Writes a synthetic volume, with its true mask and trace where they are known");
    command->add_option("KIND", options->spec.kind, "What it shows")->required()->check(CLI::IsMember(phantom_kinds()));
    command->add_option("--size", options->size, "Voxels, as in 64 or 64x32x16")->capture_default_str();
    command->add_option("--seed", options->spec.seed, "Equal seeds give equal volumes")->capture_default_str();
    command->add_option("--type", options->type, "Type of the voxels")
        ->check(CLI::IsMember(type_names()))
        ->capture_default_str();
    command
        ->add_option(
            "-o,--output", options->folder,
            "Folder for KIND.nhdr and KIND.raw, and of a kind whose truth is known (capitulum, section, "
            "roots, stem, helix, tubes, speckles, chirality) also KIND-mask.nhdr and KIND-trace.graphml, where "
            "tissues have names KIND-tissue-mask.nhdr, and where bundles lie apart from the trace "
            "KIND-partial-mask.nhdr; made where missing")
        ->required();
    add_capitulum_options(*command, *options);
    add_flaw_options(*command, *options);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr phantom tubes --size 256 --seed 1 -o phantoms\n  shvr info phantoms/tubes.nhdr\n"
        "  shvr phantom capitulum --size 128 --species bellis --noise 5 -o phantoms\n"
        "  shvr phantom roots --size 128 --gaps 30 -o phantoms\n"
        "  shvr phantom chirality -o phantoms    # a mark that no mirrored or exchanged axis leaves as it is");
    command->callback([options] { run_phantom(*options); });
}

}  // namespace shvr::cli
