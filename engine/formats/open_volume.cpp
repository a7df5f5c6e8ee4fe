#include "engine/formats/open_volume.h"

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/coarser.h"
#include "engine/formats/readers.h"
#include "engine/formats/restated.h"
#include "engine/remote/address.h"
#include "engine/volume/grid.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

struct Reader {
    const char* name;
    std::unique_ptr<VolumeSource> (*open)(const std::filesystem::path& path, const OpenOptions& options);
    bool reads_folders = false;                 ///< whether the reader is tried on folders
    bool states_size = true;                    ///< false: a side-car or the user states the volume's size
    std::array<std::string_view, 4> endings{};  ///< of names, in lower case
    std::array<std::string_view, 4> headers{};  ///< extensions of separate header files that state the size
};

/// The readers in the order in which they are tried: headers come before the raw voxels that they may describe.
constexpr Reader READERS[] = {
    {"OME-Zarr", open_ome_zarr, true, true, {".ozx", ".zip"}},
    {"TIFF", open_tiff, true, true, {".tif", ".tiff"}},
    {"NRRD", open_nrrd, false, true, {".nrrd", ".nhdr"}},
    {"MetaImage", open_mhd, false, true, {".mhd", ".mha"}},
    {"NIfTI", open_nifti, false, true, {".nii", ".nii.gz", ".hdr", ".hdr.gz"}},
    {"DICOM", open_dicom, true, true, {".dcm", ".ima"}},
    {"PNG", open_png, true, true, {".png"}},
    {"BMP", open_bmp, true, true, {".bmp"}},
    {"JPEG", open_jpeg, true, true, {".jpg", ".jpeg"}},
    {"RAW with a side-car",
     open_raw_with_side_car,
     false,
     false,
     {".raw", ".vol", ".bin", ".dat"},
     {".vgi", ".xtekct", ".vol.info", ".raw.info"}},
};

bool ends_with_one(std::string_view name, std::span<const std::string_view> endings)
{
    const std::string lower = lower_case(name);
    return std::ranges::any_of(endings, [&](std::string_view ending) {
        return !ending.empty() && lower.size() > ending.size() && lower.ends_with(ending);
    });
}

const Reader* reader_of_name(std::string_view name)
{
    for (const Reader& reader : READERS)
        if (ends_with_one(name, reader.endings) || ends_with_one(name, reader.headers)) return &reader;
    return nullptr;
}

void check_spacing(const std::filesystem::path& path, const VolumeInfo& info)
{
    for (int axis = 0; axis < 3; ++axis) {
        const double spacing = info.spacing[axis];
        if (spacing >= MIN_SPACING && spacing <= MAX_SPACING) continue;
        fail(path.string(), ": spacing along ", "xyz"[axis], " is ", spacing, " ", info.unit, "; expected ",
             MIN_SPACING, " to ", MAX_SPACING);
    }
}

[[noreturn]] void refuse_layout(const std::string& text)
{
    throw UsageError(sentence("raw layout is ", in_quotes(text),
                              "; expected WxHxD:TYPE[:big|little][:OFFSET] with TYPE ", VOXEL_TYPE_NAMES,
                              ", as in 256x256x108:int16:big:512"));
}

std::vector<std::string_view> split(std::string_view text, char separator)
{
    std::vector<std::string_view> parts;
    for (;;) {
        const size_t end = std::min(text.size(), text.find(separator));
        parts.push_back(text.substr(0, end));
        if (end == text.size()) return parts;
        text.remove_prefix(end + 1);
    }
}

}  // namespace

RawLayout parse_raw_layout(const std::string& text)
{
    const std::vector<std::string_view> parts = split(text, ':');
    if (parts.size() < 2 || parts.size() > 4) refuse_layout(text);
    RawLayout layout;
    const std::vector<std::string_view> sides = split(parts[0], 'x');
    if (sides.size() != 3) refuse_layout(text);
    for (int axis = 0; axis < 3; ++axis) {
        const std::optional<int64_t> side = whole_of(sides[size_t(axis)]);
        if (!side) refuse_layout(text);
        if (*side < 1 || *side > MAX_SIDE) {
            throw UsageError(sentence("raw layout ", in_quotes(text), ": size along ", "xyz"[axis], " is ", *side,
                                      "; expected 1 to ", int64_t{1} << 20));
        }
        layout.size[axis] = *side;
    }
    const std::optional<VoxelType> type = voxel_type_of(std::string(parts[1]));
    if (!type) refuse_layout(text);
    layout.type = *type;
    bool has_order = false;
    bool has_offset = false;
    for (size_t i = 2; i < parts.size(); ++i) {
        const std::optional<int64_t> offset = whole_of(parts[i]);
        if (!has_order && !has_offset && (parts[i] == "big" || parts[i] == "little")) {
            layout.big_endian = parts[i] == "big";
            has_order = true;
        } else if (!has_offset && offset && *offset >= 0) {
            layout.offset_bytes = *offset;
            has_offset = true;
        } else {
            refuse_layout(text);
        }
    }
    return layout;
}

std::string_view format_of_name(std::string_view name)
{
    const Reader* const reader = reader_of_name(name);
    return reader ? reader->name : std::string_view();
}

bool name_states_size(std::string_view name)
{
    const Reader* reader = reader_of_name(name);
    if (!reader && lower_case(name).ends_with(".gz")) reader = reader_of_name(name.substr(0, name.size() - 3));
    return reader && (reader->states_size || ends_with_one(name, reader->headers));
}

std::string format_names(std::string_view conjunction)
{
    std::vector<std::string_view> names;
    for (const Reader& reader : READERS)
        if (reader.states_size) names.push_back(reader.name);
    std::string text;
    for (size_t i = 0; i < names.size(); ++i) {
        const bool is_last = i + 1 == names.size();
        text += i == 0 ? "" : is_last ? " " + std::string(conjunction) + " " : ", ";
        text += names[i];
    }
    return text;
}

std::unique_ptr<VolumeSource> open_volume(const std::filesystem::path& path, const OpenOptions& options)
{
    std::error_code ignored;
    const bool is_remote = leads_to_network(path);
    const bool is_folder = std::filesystem::is_directory(path, ignored);
    std::string tried;
    for (const Reader& reader : READERS) {
        if (is_folder && !reader.reads_folders) continue;
        if (is_remote && reader.open != open_ome_zarr) continue;
        if (std::unique_ptr<VolumeSource> source = reader.open(path, options)) {
            source = restated(coarser(std::move(source), path, options.level), path, options);
            check_spacing(path, source->info());
            return source;
        }
        tried += tried.empty() ? "" : ", ";
        tried += reader.name;
    }
    if (is_folder) {
        fail(path.string(), ": is a folder without shvr/session.json and without a volume; expected a project, or ",
             "a volume as ", tried, ", or slices of bare voxels with --raw WxHxD:TYPE");
    }
    fail(path.string(), ": is in no format known here; expected ", tried, ", or bare voxels with --raw WxHxD:TYPE");
}

}  // namespace shvr
