// MetaImage (https://itk.org/Wiki/MetaIO/Documentation): a header of "key = value" lines whose last one,
// ElementDataFile, says where the voxels are: in another file (MHD) or right behind it (LOCAL, MHA).

#include <cmath>

#include "engine/base/error.h"
#include "engine/volume/header_text.h"
#include "engine/volume/readers.h"
#include "engine/volume/source_raw.h"

namespace shvr {
namespace {

constexpr const char* DATA_FILE = "ElementDataFile";

struct Header {
    HeaderFields fields;
    int64_t length = 0;  ///< bytes up to and including the line of ElementDataFile
};

Header read_header(const std::filesystem::path& path, const std::string& head)
{
    Header header{HeaderFields(path)};
    std::string_view rest = head;
    for (int line_number = 1; !rest.empty() && !header.fields.has(DATA_FILE); ++line_number) {
        const std::string_view line = take_line(rest);
        if (trimmed(line).empty()) continue;
        const size_t separator = line.find_first_of("=:");
        if (separator == std::string_view::npos) {
            fail(path.string(), ": line ", line_number, " is ", in_quotes(line), "; expected \"key = value\"");
        }
        header.fields.add(line.substr(0, separator), line.substr(separator + 1));
        // Scenes of other objects repeat their fields; they are refused by what they are.
        const std::string* type = header.fields.find("ObjectType");
        if (type != nullptr && lower_case(*type) != "image") header.fields.refuse("ObjectType", "Image");
    }
    header.length = static_cast<int64_t>(head.size() - rest.size());
    return header;
}

/// The first of these names that the header has; the first of all where it has none.
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
    fields.whole("ElementNumberOfChannels", 1, 1, 1);
    if (!fields.flag("BinaryData", true)) fields.refuse("BinaryData", "True: voxels as text are not supported");
    if (fields.flag("CompressedData", false)) {
        fields.refuse("CompressedData", "False: compressed voxels are not supported yet");
    }
}

/// Voxels are shown in the order of the file, along their own axes; what that changes is said.
void warn_of_orientation(const HeaderFields& fields, VolumeInfo& info)
{
    const char* const name = first_of(fields, {"TransformMatrix", "Rotation", "Orientation"});
    if (!fields.has(name)) return;
    const std::vector<double> m = fields.numbers(name, 9);
    bool is_identity = true;
    for (size_t i = 0; i < 9; ++i) is_identity &= std::abs(m[i] - (i % 4 == 0 ? 1.0 : 0.0)) < 1e-9;
    if (is_identity) return;
    info.warnings.push_back(sentence(name, " is not the identity; the volume is shown along its own axes"));
    const glm::dmat3 matrix(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]);
    if (glm::determinant(matrix) < 0.0) {
        info.warnings.emplace_back("axes are left-handed; the volume is shown as its mirror image");
    }
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

RawVoxels place_voxels(const Header& header, VolumeInfo& info)
{
    const HeaderFields& fields = header.fields;
    RawVoxels voxels;
    const char* const order = first_of(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
    voxels.big_endian = fields.flag(order, false);
    if (bytes_of(info.type) > 1 && !fields.has(order)) info.warnings.emplace_back(NO_BYTE_ORDER);

    const std::string& stated = fields.required(DATA_FILE, "the name of the file that holds the voxels, or LOCAL");
    const int64_t skip = fields.whole("HeaderSize", 0, -1, int64_t{1} << 62);
    voxels.offset_bytes = skip;
    if (lower_case(stated) == "local") {
        voxels.file = fields.path();
        if (skip != RawVoxels::AT_END) voxels.offset_bytes = header.length + skip;
        return voxels;
    }
    if (stated.starts_with("LIST") || (stated.find('%') != std::string::npos && words_of(stated).size() >= 4)) {
        fields.refuse(DATA_FILE, "one file: voxels spread over several files are not supported yet");
    }
    voxels.file = fields.data_file(DATA_FILE);
    return voxels;
}

}  // namespace

std::unique_ptr<VolumeSource> open_mhd(const std::filesystem::path& path, const OpenOptions& /*options*/)
{
    const std::string extension = lower_case(path.extension().string());
    const std::string start = read_head(path, 10);
    const bool looks_mine = start.starts_with("ObjectType") || start.starts_with("NDims");
    if (!looks_mine && extension != ".mhd" && extension != ".mha") return nullptr;

    const Header header = read_header(path, read_head(path));
    const HeaderFields& fields = header.fields;
    refuse_what_is_not_supported(fields);
    VolumeInfo info{.name = path.filename().string(), .format = "mhd"};
    info.size = fields.size("DimSize");
    info.type = fields.type("ElementType");
    read_spacing(fields, info);
    warn_of_orientation(fields, info);
    const RawVoxels voxels = place_voxels(header, info);
    return open_raw_voxels(std::move(info), voxels);
}

}  // namespace shvr
