// Reads headers that CT scanners write next to raw voxels: VGStudio's .vgi, Nikon's .xtekct, and .vol.info of PyHST
// (ESRF). None of these formats is documented publicly; the layouts are derived from sample files.

#include <array>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/orientation.h"
#include "engine/formats/raw/side_cars.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view FILE_SECTION = "[file1]", NEXT_FILE_SECTION = "[file2]";

/// Adds lines "name = value" to `fields`: if `is_inside`, those inside the section that describes the voxel file,
/// otherwise those outside of that section. If a field repeats, the first one counts.
void add_lines(std::string_view text, bool is_inside, HeaderFields& fields)
{
    bool is_of_file = false;
    while (!text.empty()) {
        const std::string_view line = trimmed(take_line(text));
        if (line.starts_with('[') || line.starts_with('{')) is_of_file = line == FILE_SECTION;
        const size_t equals = line.find('=');
        if (is_of_file != is_inside || equals == std::string_view::npos || line.starts_with('!')) continue;
        const std::string name(trimmed(line.substr(0, equals)));
        if (!name.empty() && !fields.has(name.c_str())) fields.add(name, trimmed(line.substr(equals + 1)));
    }
}

HeaderFields fields_of(const fs::path& path)
{
    HeaderFields fields(path);
    const std::string head = read_head(path);
    if (head.find(NEXT_FILE_SECTION) != std::string::npos)
        fail(path.string(), ": describes voxels in several files, from ", NEXT_FILE_SECTION, " on; expected one file");
    add_lines(head, true, fields);
    add_lines(head, false, fields);
    return fields;
}

Size3 size_of(const HeaderFields& fields, const std::array<const char*, 3>& names)
{
    Size3 size(0);
    for (int axis = 0; axis < 3; ++axis) {
        fields.required(names[size_t(axis)], "a number of voxels");
        size[axis] = fields.whole(names[size_t(axis)], 0, 1, MAX_SIDE);
    }
    return size;
}

/// Returns the type that follows from the file's size and the number of voxels, for headers that state no type.
VoxelType type_by_size(const HeaderFields& fields, const fs::path& voxels, VolumeInfo& info)
{
    std::error_code error;
    const auto bytes = int64_t(fs::file_size(voxels, error));
    const int64_t count = voxel_count(info);
    for (const VoxelType type : {VoxelType::float32, VoxelType::uint16, VoxelType::uint8}) {
        if (error || bytes % count != 0 || bytes / count != int64_t(bytes_of(type))) continue;
        info.warnings.push_back(sentence("no voxel type stated; ", name_of(type), " is assumed, since the file has ",
                                         bytes_of(type),
                                         bytes_of(type) == 1 ? " byte for each voxel" : " bytes for each voxel"));
        return type;
    }
    if (error)
        fail(voxels.string(), ": cannot be read: ", error.message(), "; expected the voxels that ",
             fields.path().filename().string(), " describes");
    fail(voxels.string(), ": holds ", bytes, " bytes; expected 1, 2 or 4 for each of the ", count, " voxels that ",
         fields.path().filename().string(), " states");
}

double above_zero(const HeaderFields& fields, const char* name)
{
    const double number = fields.numbers(name, 1)[0];
    if (!(number > 0.0)) fields.refuse(name, "a number above 0");
    return number;
}

// ---- PyHST ----------------------------------------------------------------------------------------------------------

SideCar read_vol_info(const HeaderFields& fields, fs::path raw)
{
    if (raw.empty()) raw = fs::path(fields.path()).replace_extension("");  // scan.vol.info
    SideCar made;
    made.info.size = size_of(fields, {"NUM_X", "NUM_Y", "NUM_Z"});
    made.info.type = type_by_size(fields, raw, made.info);
    made.voxels.file = std::move(raw);
    made.voxels.big_endian.reset();
    if (const std::string* const order = fields.find("BYTEORDER")) {
        if (*order != "LOWBYTEFIRST" && *order != "HIGHBYTEFIRST")
            fields.refuse("BYTEORDER", "LOWBYTEFIRST or HIGHBYTEFIRST");
        made.voxels.big_endian = *order == "HIGHBYTEFIRST";
    }
    // In micrometres; 0 where it was unknown.
    const bool has_spacing = fields.has("voxelSize") && fields.numbers("voxelSize", 1)[0] != 0.0;
    if (has_spacing)
        apply_spacing(made.info, glm::dvec3(above_zero(fields, "voxelSize")), "um", "um");
    else
        apply_spacing(made.info, {}, {}, "um");
    return made;
}

// ---- Nikon ----------------------------------------------------------------------------------------------------------

SideCar read_xtekct(const HeaderFields& fields, fs::path raw)
{
    for (const char* ending : {".vol", ".raw"})
        if (raw.empty() && is_file(fs::path(fields.path()).replace_extension(ending)))
            raw = fs::path(fields.path()).replace_extension(ending);
    if (raw.empty())
        fail(fields.path().string(), ": is a Nikon header, and its voxels are missing; expected ",
             fs::path(fields.path()).replace_extension(".vol").filename().string(), " next to it");
    SideCar made;
    made.info.size = size_of(fields, {"VoxelsX", "VoxelsY", "VoxelsZ"});
    made.info.type = type_by_size(fields, raw, made.info);
    made.voxels.file = std::move(raw);
    const bool has_spacing = fields.has("VoxelSizeX") && fields.has("VoxelSizeY") && fields.has("VoxelSizeZ");
    if (has_spacing)
        apply_spacing(made.info,
                      glm::dvec3(above_zero(fields, "VoxelSizeX"), above_zero(fields, "VoxelSizeY"),
                                 above_zero(fields, "VoxelSizeZ")),
                      "mm", "mm");
    else
        apply_spacing(made.info, {}, {}, "mm");
    return made;
}

// ---- VGStudio -------------------------------------------------------------------------------------------------------

VoxelType type_of_vgi(const HeaderFields& fields)
{
    const int64_t bits = fields.whole("BitsPerElement", 0, 8, 64);
    const std::string& kind = fields.required("Datatype", "unsigned integer, signed integer or float");
    const std::string plain = lower_case(kind);
    const auto refuse_bits = [&] { fields.refuse("BitsPerElement", "8, 16 or 32; or 32 or 64 of floats"); };
    if (plain == "float") {
        if (bits != 32 && bits != 64) refuse_bits();
        return bits == 32 ? VoxelType::float32 : VoxelType::float64;
    }
    const bool is_signed = plain == "signed integer" || plain == "integer";
    if (!is_signed && plain != "unsigned integer")
        fields.refuse("Datatype", "unsigned integer, signed integer or float");
    if (bits != 8 && bits != 16 && bits != 32) refuse_bits();
    if (bits == 8) return is_signed ? VoxelType::int8 : VoxelType::uint8;
    if (bits == 16) return is_signed ? VoxelType::int16 : VoxelType::uint16;
    return is_signed ? VoxelType::int32 : VoxelType::uint32;
}

SideCar read_vgi(const HeaderFields& fields, fs::path raw)
{
    if (raw.empty()) raw = fields.data_file("Name");
    if (const std::string* const format = fields.find("FileFormat"); format && lower_case(*format) != "raw")
        fields.refuse("FileFormat", "raw");
    SideCar made;
    made.info.size = fields.size("Size");
    made.info.type = type_of_vgi(fields);
    made.voxels.file = std::move(raw);
    made.voxels.offset_bytes = fields.whole("SkipHeader", 0, 0, int64_t{1} << 40);
    if (fields.has("resolution"))
        apply_spacing(made.info, fields.spacing("resolution"),
                      fields.has("unit") ? std::optional(fields.required("unit", "a unit")) : std::nullopt, "mm");
    else
        apply_spacing(made.info, {}, {}, "mm");
    return made;
}

/// Whether the header names an existing file other than `raw`. A missing file does not count, as files may be renamed.
bool is_of_another(const HeaderFields& fields, const fs::path& raw)
{
    const std::string* const name = fields.find("Name");
    if (name == nullptr) return false;
    const fs::path stated = file_stated(fields.path(), *name);
    return is_file(stated) && stated.filename() != raw.filename();
}

}  // namespace

bool is_scanner_header(const fs::path& path)
{
    const std::string name = lower_case(path.filename().string());
    return name.ends_with(".vgi") || name.ends_with(".xtekct") || name.ends_with(".vol.info") ||
           name.ends_with(".raw.info");
}

SideCar read_scanner_header(const fs::path& path, fs::path raw)
{
    const HeaderFields fields = fields_of(path);
    const std::string extension = lower_case(path.extension().string());
    SideCar made = extension == ".vgi"      ? read_vgi(fields, std::move(raw))
                   : extension == ".xtekct" ? read_xtekct(fields, std::move(raw))
                                            : read_vol_info(fields, std::move(raw));
    static_cast<void>(voxel_count(made.info));
    return made;
}

std::optional<SideCar> find_scanner_header(const fs::path& raw)
{
    const fs::path info = fs::path(raw) += ".info";
    if (is_file(info) && is_scanner_header(info)) return read_scanner_header(info, raw);
    for (const char* ending : {".vgi", ".xtekct"}) {
        const fs::path header = fs::path(raw).replace_extension(ending);
        if (!is_file(header)) continue;
        if (std::string_view(ending) == ".vgi" && is_of_another(fields_of(header), raw)) continue;
        return read_scanner_header(header, raw);
    }
    return {};
}

}  // namespace shvr
