// Opens NIfTI-1 and NIfTI-2: .nii, .nii.gz, and pairs of .hdr and .img, either of which may be compressed.

#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/data_files.h"
#include "engine/formats/headers/nifti_header.h"
#include "engine/formats/inflated_bytes.h"
#include "engine/formats/orientation.h"
#include "engine/formats/raw/source_raw.h"
#include "engine/formats/readers.h"
#include "engine/formats/rescaled.h"
#include "engine/formats/stored_numbers.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

struct Datatype {
    int code;
    VoxelType type;
    int64_t channels;
    StoredNumber number = StoredNumber::plain;
};
constexpr Datatype DATATYPES[] = {
    {2, VoxelType::uint8, 1},
    {256, VoxelType::int8, 1},
    {512, VoxelType::uint16, 1},
    {4, VoxelType::int16, 1},
    {768, VoxelType::uint32, 1},
    {8, VoxelType::int32, 1},
    {16, VoxelType::float32, 1},
    {64, VoxelType::float64, 1},
    {128, VoxelType::uint8, 3},
    {2304, VoxelType::uint8, 4},
    {1024, VoxelType::float64, 1, StoredNumber::int64},
    {1280, VoxelType::float64, 1, StoredNumber::uint64},
};
constexpr std::pair<int, const char*> REFUSED[] = {{0, "unknown"},     {1, "bits"},          {32, "complex64"},
                                                   {1536, "float128"}, {1792, "complex128"}, {2048, "complex256"}};

Datatype datatype_of(const std::string& file, int code)
{
    for (const Datatype& datatype : DATATYPES) {
        if (datatype.code == code) return datatype;
    }
    const char* name = "no type known here";
    for (const auto& [refused, its_name] : REFUSED) {
        if (refused == code) name = its_name;
    }
    fail(file, ": datatype is ", code, ", which is ", name,
         "; expected integers of 8, 16, 32 or 64 bits, floats of 32 or 64, RGB24 or RGBA32");
}

/// The first bytes, decompressed if necessary.
std::string head_of(const fs::path& path, bool& is_compressed)
{
    const std::string head = read_head(path, NiftiHeader::BYTES_OF_2);
    is_compressed = begins_as_gzip(head);
    return is_compressed ? inflated_head(path, NiftiHeader::BYTES_OF_2) : head;
}

/// Replaces an ending: from ".hdr" to ".img", scan.hdr.gz becomes scan.img.gz. Empty if the name has another ending.
fs::path with_ending(const fs::path& path, std::string_view from, const std::string& to)
{
    std::string name = path.filename().string();
    const std::string lower = lower_case(name);
    const std::string gz = lower.ends_with(".gz") ? name.substr(name.size() - 3) : std::string();
    name.resize(name.size() - gz.size());
    if (!lower_case(name).ends_with(from)) return {};
    name.resize(name.size() - from.size());
    const fs::path same = path.parent_path() / (name + to + gz);
    std::error_code ignored;
    if (fs::exists(same, ignored)) return same;
    const fs::path other = path.parent_path() / (name + to + (gz.empty() ? ".gz" : ""));
    return fs::exists(other, ignored) ? other : same;
}

/// The content of a file: a volume of size `size` for each time point and each component.
struct Shape {
    Size3 size{1};
    int64_t frames = 1;
    int64_t components = 1;
};

Shape shape_of(const std::string& file, const NiftiHeader& header)
{
    const int64_t count = header.dim[0];
    if (count < 1 || count > 7) fail(file, ": dim[0] is ", count, "; expected 1 to 7 axes");
    const int64_t most = header.version == 1 ? 32767 : MAX_SIDE;
    for (size_t i = 1; i <= size_t(count); ++i) {
        const int64_t side = header.dim[i];
        if (side >= 1 && side <= most && (i <= 5 || side == 1)) continue;
        const bool overflowed = header.version == 1 && side < 0;
        fail(file, ": dim[", i, "] is ", side, "; expected ", i <= 5 ? sentence("1 to ", most) : std::string("1"),
             overflowed ? ": longer sides need NIfTI-2" : "");
    }
    const auto side = [&](size_t i) { return int64_t(i) <= count ? header.dim[i] : 1; };
    return {{side(1), side(2), side(3)}, side(4), side(5)};
}

/// Chooses one of the file's volumes, which are stored one after the other, with time points varying fastest.
void choose_volume(const std::string& file, const OpenOptions& options, const Shape& shape, const Datatype& datatype,
                   VolumeInfo& info, RawVoxels& voxels)
{
    const int64_t frame = chosen_frame(file, options, shape.frames);
    voxels.channels = datatype.channels;
    int64_t component = 0;
    if (datatype.channels > 1 && shape.components > 1) {
        fail(file, ": dim[5] is ", shape.components, "; expected 1 for colour voxels");
    }
    if (shape.components > 1) {
        component = chosen_channel(file, options, shape.components);
    } else {
        voxels.channel = chosen_channel(file, options, datatype.channels, color_names(datatype.channels));
    }
    int64_t bytes = 0;
    int64_t all = 0;
    if (__builtin_mul_overflow(voxel_count(info), int64_t(bytes_of(info.type)) * datatype.channels, &bytes) ||
        __builtin_mul_overflow(bytes, shape.frames * shape.components, &all) ||
        __builtin_add_overflow(all, int64_t{1} << 62, &all)) {
        fail(file, ": dim states voxels of more than 2^62 bytes; expected fewer");
    }
    const int64_t before = component * shape.frames + frame;
    (voxels.is_deflated ? voxels.skip_bytes : voxels.offset_bytes) += before * bytes;
    voxels.bytes_after = (shape.frames * shape.components - 1 - before) * bytes;
}

int64_t voxels_at(const std::string& file, const NiftiHeader& header)
{
    const int64_t header_bytes = header.version == 1 ? 348 : 540;
    const double stated = header.voxels_at;
    if (!header.is_pair && stated == 0.0) return header_bytes + 4;
    constexpr double MOST = 4.0e15;
    const auto least = double(header.is_pair ? 0 : header_bytes);
    if (!(stated >= least && stated <= MOST) || stated != std::floor(stated)) {
        fail(file, ": vox_offset is ", stated, "; expected a whole number of bytes from ", least);
    }
    return int64_t(stated);
}

std::optional<std::string> unit_of(const NiftiHeader& header)
{
    switch (header.units & 7) {
        case 1: return "m";
        case 2: return "mm";
        case 3: return "um";
        default: return {};
    }
}

/// Returns the spacing for files without valid axes: the absolute values of pixdim, with 1 in place of invalid ones.
std::optional<glm::dvec3> spacing_of_pixdim(const NiftiHeader& header, VolumeInfo& info)
{
    glm::dvec3 spacing(1.0);
    int known = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double stated = header.pixdim[size_t(axis) + 1];
        const bool is_known = std::isfinite(stated) && stated != 0.0;
        known += is_known ? 1 : 0;
        if (is_known) spacing[axis] = std::abs(stated);
        if (!is_known || stated < 0.0) {
            info.warnings.push_back(sentence("pixdim[", axis + 1, "] is ", stated, "; spacing ", spacing[axis],
                                             " along ", "xyz"[axis], " assumed"));
        }
    }
    return known == 0 ? std::nullopt : std::optional(spacing);
}

void warn_where_forms_disagree(const NiftiHeader& header, const glm::dvec3& spacing, VolumeInfo& info)
{
    for (int axis = 0; axis < 3; ++axis) {
        const double stated = std::abs(header.pixdim[size_t(axis) + 1]);
        if (!(std::abs(stated - spacing[axis]) > 0.01 * spacing[axis])) continue;
        info.warnings.push_back(sentence("spacing along ", "xyz"[axis], " is ", spacing[axis], " by the sform and ",
                                         stated, " by pixdim; that of the sform is used"));
    }
}

void describe_space(const NiftiHeader& header, VolumeInfo& info)
{
    std::optional<glm::dvec3> spacing;
    if (const auto sform = sform_axes(header)) {
        spacing = place(info, sform->steps, sform->origin, "RAS");
        warn_where_forms_disagree(header, *spacing, info);
    } else if (const auto qform = qform_axes(header)) {
        spacing = place(info, qform->steps, qform->origin, "RAS");
    } else {
        if (header.sform_code > 0 || header.qform_code > 0) {
            info.warnings.emplace_back("sform and qform are singular; the orientation is ignored");
        }
        spacing = spacing_of_pixdim(header, info);
    }
    apply_spacing(info, spacing, unit_of(header), "mm");
}

Rescale rescale_of(const NiftiHeader& header, const Datatype& datatype, VolumeInfo& info)
{
    if (header.slope == 0.0 || datatype.channels > 1) return {};  // 0: stored unscaled
    if (!std::isfinite(header.slope) || !std::isfinite(header.intercept)) {
        info.warnings.push_back(sentence("scl_slope is ", header.slope, " and scl_inter ", header.intercept,
                                         "; intensities are shown as stored"));
        return {};
    }
    return {.slope = header.slope, .intercept = header.intercept};
}

}  // namespace

std::unique_ptr<VolumeSource> open_nifti(const fs::path& path, const OpenOptions& options)
{
    if (const fs::path beside = with_ending(path, ".img", ".hdr"); !beside.empty()) {
        std::error_code ignored;
        return fs::exists(beside, ignored) ? open_nifti(beside, options) : nullptr;
    }
    bool is_compressed = false;
    const std::string head = head_of(path, is_compressed);
    const std::optional<NiftiHeader> header = parse_nifti_header(head);
    const std::string file = path.string();
    if (!header) {
        const std::string lower = lower_case(path.filename().string());
        if (lower.ends_with(".nii") || lower.ends_with(".nii.gz")) {
            fail(file,
                 ": does not begin with a NIfTI header; expected one of 348 bytes with the magic n+1, or of 540 bytes "
                 "with n+2");
        }
        if (!with_ending(path, ".hdr", ".img").empty() && is_analyze_header(head)) {
            fail(file,
                 ": is in the format Analyze 7.5, which does not state the directions of its axes; expected NIfTI");
        }
        return nullptr;
    }

    VolumeInfo info{.name = path.filename().string(), .format = "nifti"};
    const Datatype datatype = datatype_of(file, header->datatype);
    const Shape shape = shape_of(file, *header);
    info.size = shape.size;
    info.type = datatype.type;
    describe_space(*header, info);

    RawVoxels voxels{.file = path, .big_endian = header->big_endian, .is_deflated = is_compressed};
    if (header->is_pair) {
        voxels.file = with_ending(path, ".hdr", ".img");
        if (voxels.file.empty()) fail(file, ": its voxels are in another file; expected a name that ends in .hdr");
        voxels.is_deflated = begins_as_gzip(read_head(voxels.file, 2));
    }
    (voxels.is_deflated ? voxels.skip_bytes : voxels.offset_bytes) = voxels_at(file, *header);
    choose_volume(file, options, shape, datatype, info, voxels);
    const Rescale rescale = rescale_of(*header, datatype, info);
    std::unique_ptr<VolumeSource> source = widened(open_raw_voxels(std::move(info), voxels), datatype.number, file);
    return rescaled(right_handed(std::move(source)), rescale);
}

}  // namespace shvr
