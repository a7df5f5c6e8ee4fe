// Opens MetaImage (https://itk.org/Wiki/MetaIO/Documentation): a header of "key = value" lines. The last key,
// ElementDataFile, states where the voxels are: in one or many other files (MHD), or after the header (LOCAL, MHA).
// They are raw or compressed with zlib.

#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/data_files.h"
#include "engine/formats/orientation.h"
#include "engine/formats/raw/source_raw.h"
#include "engine/formats/readers.h"
#include "engine/formats/rescaled.h"

namespace shvr {
namespace {

constexpr const char* DATA_FILE = "ElementDataFile";

struct MhdHeader {
    HeaderFields fields;
    int64_t length = 0;            ///< bytes up to and including the line ElementDataFile
    std::string_view file_list{};  ///< the lines after ElementDataFile
};

MhdHeader read_mhd_header(const std::filesystem::path& path, const std::string& head)
{
    MhdHeader header{HeaderFields(path)};
    std::string_view rest = head;
    for (int line_number = 1; !rest.empty() && !header.fields.has(DATA_FILE); ++line_number) {
        const std::string_view line = take_line(rest);
        if (trimmed(line).empty()) continue;
        const size_t separator = line.find_first_of("=:");
        if (separator == std::string_view::npos) {
            fail(path.string(), ": line ", line_number, " is ", in_quotes(line), "; expected \"key = value\"");
        }
        header.fields.add(line.substr(0, separator), line.substr(separator + 1));
        // Checks the object type before other errors: headers of objects other than images may repeat fields.
        const std::string* type = header.fields.find("ObjectType");
        if (type != nullptr && lower_case(*type) != "image") header.fields.refuse("ObjectType", "Image");
    }
    header.length = int64_t(head.size() - rest.size());
    header.file_list = rest;
    return header;
}

/// Returns the first of `names` that the header contains; if it contains none of them, the first of `names`.
const char* first_of(const HeaderFields& fields, std::initializer_list<const char*> names)
{
    for (const char* name : names) {
        if (fields.has(name)) return name;
    }
    return *names.begin();
}

void refuse_what_is_not_supported(const HeaderFields& fields)
{
    fields.required("NDims", "3");
    fields.whole("NDims", 3, 3, 3);
    if (!fields.flag("BinaryData", true)) fields.refuse("BinaryData", "True: voxels as text are not supported");
}

/// Sets the directions and the origin. MetaImage names no frame: if the file states an anatomical orientation, the
/// frame is assumed to be LPS, as in ITK, which writes most of these files. The orientation's letters are ignored,
/// since some programs name the side where an axis begins, and others the side where it ends.
void read_orientation(const HeaderFields& fields, VolumeInfo& info)
{
    const char* const matrix = first_of(fields, {"TransformMatrix", "Rotation", "Orientation"});
    const char* const offset = first_of(fields, {"Offset", "Position", "Origin"});
    const std::string* letters = fields.find("AnatomicalOrientation");
    const std::string frame = letters != nullptr && letters->find('?') == std::string::npos ? "LPS" : "";
    glm::dmat3 steps(1.0);
    if (fields.has(matrix)) {
        const std::vector<double> m = fields.numbers(matrix, 9);
        steps = glm::dmat3(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]);
        for (int axis = 0; axis < 3; ++axis) {
            const double length = glm::length(steps[axis]);
            if (!(length > 0.0) || !std::isfinite(length))
                fields.refuse(matrix, "three vectors of finite length greater than 0");
        }
    }
    glm::dvec3 origin(0.0);
    if (fields.has(offset)) {
        const std::vector<double> numbers = fields.numbers(offset, 3);
        for (int axis = 0; axis < 3; ++axis) {
            origin[axis] = numbers[size_t(axis)];
            if (!std::isfinite(origin[axis])) fields.refuse(offset, "3 finite numbers");
        }
    }
    static_cast<void>(place(info, steps, origin, frame));
}

void read_spacing(const HeaderFields& fields, VolumeInfo& info)
{
    const char* const name = first_of(fields, {"ElementSpacing", "ElementSize"});
    std::optional<glm::dvec3> spacing;
    if (fields.has(name)) spacing = fields.spacing(name);
    std::optional<std::string> unit;
    if (const std::string* stated = fields.find("DistanceUnits"); stated != nullptr && *stated != "?") unit = *stated;
    apply_spacing(info, spacing, unit, "mm");
}

RawVoxels place_voxels(const MhdHeader& header, const VolumeInfo& info)
{
    const HeaderFields& fields = header.fields;
    RawVoxels voxels;
    const char* const order = first_of(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
    voxels.big_endian = std::nullopt;
    if (fields.has(order)) voxels.big_endian = fields.flag(order, false);
    voxels.is_deflated = fields.flag("CompressedData", false);

    const std::string& stated = fields.required(DATA_FILE, "the name of the file that holds the voxels, or LOCAL");
    const int64_t skip = fields.whole("HeaderSize", 0, voxels.is_deflated ? 0 : -1, int64_t{1} << 62);
    voxels.offset_bytes = skip;
    if (lower_case(stated) == "local") {
        voxels.file = fields.path();
        if (skip != RawVoxels::AT_END) voxels.offset_bytes = header.length + skip;
    } else if (is_list(stated) || is_pattern(stated)) {
        for (const auto& file : data_files(fields, DATA_FILE, header.file_list, info.size)) {
            voxels.parts.push_back({file, skip});
        }
    } else {
        voxels.file = fields.data_file(DATA_FILE);
    }
    return voxels;
}

/// What the numbers of the file mean.
Rescale read_intensities(const HeaderFields& fields)
{
    const char* const slope = "ElementToIntensityFunctionSlope";
    const char* const offset =
        first_of(fields, {"ElementToIntensityFunctionOffset", "ElementToIntensityFunctionIntercept"});
    Rescale rescale;
    if (fields.has(slope)) rescale.slope = fields.numbers(slope, 1)[0];
    if (fields.has(offset)) rescale.intercept = fields.numbers(offset, 1)[0];
    if (!std::isfinite(rescale.slope) || rescale.slope == 0.0) fields.refuse(slope, "a finite number other than 0");
    if (!std::isfinite(rescale.intercept)) fields.refuse(offset, "a finite number");
    return rescale;
}

}  // namespace

std::unique_ptr<VolumeSource> open_mhd(const std::filesystem::path& path, const OpenOptions& options)
{
    const std::string extension = lower_case(path.extension().string());
    const std::string start = read_head(path, 10);
    const bool looks_mine = start.starts_with("ObjectType") || start.starts_with("NDims");
    if (!looks_mine && extension != ".mhd" && extension != ".mha") return nullptr;

    const std::string head = read_head(path);
    const MhdHeader header = read_mhd_header(path, head);
    const HeaderFields& fields = header.fields;
    refuse_what_is_not_supported(fields);
    VolumeInfo info{.name = path.filename().string(), .format = "mhd"};
    info.size = fields.size("DimSize");
    const auto [type, number] = fields.type_or_wide("ElementType");
    info.type = type;
    read_spacing(fields, info);
    read_orientation(fields, info);
    RawVoxels voxels = place_voxels(header, info);
    voxels.channels = fields.whole("ElementNumberOfChannels", 1, 1, 65536);
    voxels.channel = chosen_channel(path.string(), options, voxels.channels, color_names(voxels.channels));
    const Rescale rescale = read_intensities(fields);
    std::unique_ptr<VolumeSource> source = widened(open_raw_voxels(std::move(info), voxels), number, path.string());
    return rescaled(right_handed(std::move(source)), rescale);
}

}  // namespace shvr
