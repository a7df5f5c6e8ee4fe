#include "engine/formats/export/volume_export.h"

#include <algorithm>
#include <bit>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/unit.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

constexpr int64_t STRIP_BYTES = int64_t{1} << 18;

std::string form_of(const std::filesystem::path& path)
{
    return lower_case(path.extension().string());
}

/// "(1,2,3)"
std::string in_brackets(const glm::dvec3& vector)
{
    return sentence("(", digits_of(vector.x), ",", digits_of(vector.y), ",", digits_of(vector.z), ")");
}

/// Sizes and orientation of the axes. The format requires the space before the fields that refer to it.
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

}  // namespace

int64_t export_rows(const VolumeInfo& info)
{
    const int64_t row_bytes = info.size.x * int64_t(bytes_of(info.type));
    return std::clamp<int64_t>(STRIP_BYTES / row_bytes, 1, info.size.y);
}

void export_nrrd(const std::filesystem::path& path, const VolumeSource& source)
{
    static_assert(std::endian::native == std::endian::little);
    const VolumeInfo& info = source.info();
    const char* const type = info.type == VoxelType::float32   ? "float"
                             : info.type == VoxelType::float64 ? "double"
                                                               : name_of(info.type);
    const std::string header = sentence("NRRD0004\ntype: ", type, "\ndimension: 3\n", nrrd_axes(info),
                                        bytes_of(info.type) > 1 ? "\nendian: little" : "", "\nencoding: raw\n\n");
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

void export_volume(const std::filesystem::path& path, const VolumeSource& source, const Progress& progress)
{
    static_cast<void>(voxel_count(source.info()));
    if (!is_volume_export(path))
        fail(path.string(), ": has the extension ", in_quotes(path.extension().string()), "; expected .nrrd or .tif");
    const ToldSource told(source, progress);
    if (form_of(path) == ".nrrd") return export_nrrd(path, told);
    export_tiff(path, told);
}

}  // namespace shvr
