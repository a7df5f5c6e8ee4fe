#include "engine/formats/export/volume_export.h"

#include <algorithm>
#include <bit>
#include <string_view>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/unit.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

constexpr int64_t STRIP_BYTES = int64_t{1} << 18;
/// Maximum compression ratio of deflate, the compression of exported TIFFs: 258 bytes in 2 bits.
constexpr int64_t MAX_DEFLATION = 1032;
constexpr const char* LESS_SPACE = "free some of it, or choose .zarr, which holds what is painted alone";

std::string form_of(const std::filesystem::path& path)
{
    return lower_case(path.extension().string());
}

/// "(1,2,3)"
std::string in_brackets(const glm::dvec3& vector)
{
    return sentence("(", digits_of(vector.x), ",", digits_of(vector.y), ",", digits_of(vector.z), ")");
}

/// Returns the fields for sizes and orientation. In NRRD, "space" must precede the fields that refer to it.
std::string nrrd_axes(const VolumeInfo& info)
{
    // Quotes would end the unit's name.
    std::string unit = plain_unit(info.unit);
    std::ranges::replace(unit, '"', '\'');
    const std::string quoted = "\"" + unit + "\"", units = quoted + " " + quoted + " " + quoted;
    const std::string sizes = "sizes: " + digits_of(info.size) + "\n";
    if (!states_place(info)) return sentence(sizes, "spacings: ", digits_of(info.spacing), "\nunits: ", units);
    const char* const space = info.frame == "RAS"   ? "space: right-anterior-superior"
                              : info.frame == "LPS" ? "space: left-posterior-superior"
                                                    : "space dimension: 3";
    std::string steps;
    for (int axis = 0; axis < 3; ++axis) steps += " " + in_brackets(info.directions[axis] * info.spacing[axis]);
    return sentence(space, "\n", sizes, "space directions:", steps,
                    "\nkinds: domain domain domain\nspace units: ", units,
                    "\nspace origin: ", in_brackets(info.origin));
}

/// Whether a field of the replaced file stays valid: it is about neither voxels nor axes, or the axes are unchanged.
bool is_kept(const std::string& field, bool has_same_axes, bool has_space)
{
    constexpr std::string_view ANY[] = {"content", "number", "sample units", "sampleunits"};
    constexpr std::string_view OF_AXES[] = {"thicknesses", "labels", "centers", "centerings"};
    if (std::ranges::find(ANY, field) != std::end(ANY)) return true;
    if (field == "measurement frame") return has_space;
    return has_same_axes && std::ranges::find(OF_AXES, field) != std::end(OF_AXES);
}

std::string value_of(const NrrdHead& head, std::string_view field)
{
    const auto found = std::ranges::find(head.fields, field, &NrrdPair::key);
    return found != head.fields.end() ? found->value : std::string();
}

std::string nrrd_header(const VolumeInfo& info, NrrdHead kept)
{
    const char* const type = info.type == VoxelType::float32   ? "float"
                             : info.type == VoxelType::float64 ? "double"
                                                               : name_of(info.type);
    std::string header = sentence("NRRD000", std::max(kept.version, 4), "\n");
    for (const std::string& comment : kept.comments) header += comment + "\n";
    header += sentence("type: ", type, "\ndimension: 3\n", nrrd_axes(info),
                       bytes_of(info.type) > 1 ? "\nendian: little" : "", "\nencoding: raw\n");
    const bool has_same_axes =
        value_of(kept, "dimension") == "3" && words_of(value_of(kept, "sizes")) == words_of(digits_of(info.size));
    for (const NrrdPair& field : kept.fields)
        if (is_kept(field.key, has_same_axes, states_place(info))) header += field.key + ": " + field.value + "\n";
    if (info.format == "mask" || info.format == "offsets")
        set_pair(kept.pairs, NRRD_CONTENT_KEY, info.format);
    else
        std::erase_if(kept.pairs, [](const NrrdPair& pair) { return pair.key == NRRD_CONTENT_KEY; });
    for (const NrrdPair& pair : kept.pairs) header += spelled(pair) + "\n";
    return header + "\n";
}

}  // namespace

int64_t export_rows(const VolumeInfo& info)
{
    const int64_t row_bytes = info.size.x * int64_t(bytes_of(info.type));
    return std::clamp<int64_t>(STRIP_BYTES / row_bytes, 1, info.size.y);
}

void export_nrrd(const std::filesystem::path& path, const VolumeSource& source, const NrrdHead& kept)
{
    static_assert(std::endian::native == std::endian::little);
    const VolumeInfo& info = source.info();
    const std::string header = nrrd_header(info, kept);
    AtomicWriter writer(path);
    writer.append(std::as_bytes(std::span(header)));
    const int64_t step = export_rows(info);
    std::vector<std::byte> voxels;
    for (int64_t z = 0; z < info.size.z; ++z)
        for (int64_t y = 0; y < info.size.y; y += step) {
            const VoxelBox box{{0, y, z}, {info.size.x, std::min(y + step, info.size.y), z + 1}};
            voxels.resize(size_t(box.size().x * box.size().y) * bytes_of(info.type));
            source.read(box, voxels);
            writer.append(voxels);
        }
    writer.commit();
}

bool is_volume_export(const std::filesystem::path& path)
{
    const std::string form = form_of(path);
    return form == ".nrrd" || form == ".tif" || form == ".tiff";
}

void export_volume(const std::filesystem::path& path, const VolumeSource& source, const Progress& progress,
                   const std::optional<NrrdHead>& kept)
{
    static_cast<void>(voxel_count(source.info()));
    if (!is_volume_export(path))
        fail(path.string(), ": has the extension ", in_quotes(path.extension().string()), "; expected .nrrd or .tif");
    const ToldSource told(source, progress);
    const std::optional<int64_t> bytes = multiplied(voxel_count(source.info()), int64_t(bytes_of(source.info().type)));
    if (form_of(path) == ".nrrd") {
        expect_space(path, bytes, LESS_SPACE);
        return export_nrrd(path, told, kept ? *kept : read_nrrd_head(path).value_or(NrrdHead{}));
    }
    expect_space(path, bytes.value_or(INT64_MAX) / MAX_DEFLATION, LESS_SPACE);
    export_tiff(path, told);
}

}  // namespace shvr
