// NRRD, versions 1 to 6 (http://teem.sourceforge.net/nrrd/format.html). Read is what describes bare voxels, in the
// header's own file or in another one.

#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/volume/header_text.h"
#include "engine/volume/readers.h"
#include "engine/volume/source_raw.h"

namespace shvr {
namespace {

constexpr int64_t LINE_SKIP_BYTES = int64_t{16} << 20;

struct Header {
    HeaderFields fields;
    bool is_attached = false;
    int64_t voxels_at = 0;  ///< where the header's own file goes on after the empty line
};

Header read_header(const std::filesystem::path& path, const std::string& head)
{
    Header header{HeaderFields(path)};
    std::string_view rest = head;
    const std::string_view magic = take_line(rest);
    if (magic.size() != 8 || !magic.starts_with("NRRD000") || magic[7] < '1' || magic[7] > '6') {
        fail(path.string(), ": begins with ", in_quotes(magic.substr(0, 8)), "; expected NRRD0001 to NRRD0006");
    }
    for (int line_number = 2; !rest.empty(); ++line_number) {
        const std::string_view line = take_line(rest);
        if (line.empty()) {
            header.is_attached = true;
            header.voxels_at = static_cast<int64_t>(head.size() - rest.size());
            break;
        }
        if (line.starts_with('#')) continue;
        const size_t colon = line.find(':');
        if (colon == std::string_view::npos) {
            fail(path.string(), ": line ", line_number, " is ", in_quotes(line), "; expected \"field: value\"");
        }
        if (line.substr(colon).starts_with(":=")) continue;  // free key/value pairs
        header.fields.add(line.substr(0, colon), line.substr(colon + 1));
    }
    return header;
}

/// "mm" "mm" "mm", or without quotes.
std::vector<std::string> texts_of(std::string_view value)
{
    std::vector<std::string> texts;
    for (size_t open = value.find('"'); open != std::string_view::npos; open = value.find('"')) {
        const size_t close = value.find('"', open + 1);
        if (close == std::string_view::npos) break;
        texts.emplace_back(value.substr(open + 1, close - open - 1));
        value.remove_prefix(close + 1);
    }
    if (texts.empty()) {
        for (const std::string_view word : words_of(value)) texts.emplace_back(word);
    }
    return texts;
}

std::optional<std::string> unit_of(const HeaderFields& fields)
{
    const char* const name = fields.has("space units") ? "space units" : "units";
    const std::string* value = fields.find(name);
    if (value == nullptr) return {};
    const std::vector<std::string> texts = texts_of(*value);
    if (texts.empty()) return {};
    for (const std::string& text : texts) {
        if (plain_unit(text) != plain_unit(texts[0])) fields.refuse(name, "one unit for all axes");
    }
    return texts[0];
}

/// Columns are the steps from voxel to voxel along x, y and z.
glm::dmat3 space_directions(const HeaderFields& fields)
{
    constexpr const char* NAME = "space directions";
    constexpr const char* EXPECTED = "three vectors of three numbers, (a,b,c) (d,e,f) (g,h,i)";
    std::string_view rest = fields.required(NAME, EXPECTED);
    glm::dmat3 directions(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        rest = trimmed(rest);
        const size_t close = rest.find(')');
        if (!rest.starts_with('(') || close == std::string_view::npos) fields.refuse(NAME, EXPECTED);
        std::string numbers(rest.substr(1, close - 1));
        rest.remove_prefix(close + 1);
        for (char& character : numbers) {
            if (character == ',') character = ' ';
        }
        const std::vector<std::string_view> words = words_of(numbers);
        if (words.size() != 3) fields.refuse(NAME, EXPECTED);
        for (int component = 0; component < 3; ++component) {
            const std::optional<double> number = number_of(words[static_cast<size_t>(component)]);
            if (!number || !std::isfinite(*number)) fields.refuse(NAME, EXPECTED);
            directions[axis][component] = *number;
        }
        if (!(glm::length(directions[axis]) > 0.0) || !std::isfinite(glm::length(directions[axis]))) {
            fields.refuse(NAME, "vectors of finite length above 0");
        }
    }
    if (!trimmed(rest).empty()) fields.refuse(NAME, EXPECTED);
    return directions;
}

bool space_is_left_handed(const HeaderFields& fields)
{
    const std::string* value = fields.find("space");
    const std::string space = value == nullptr ? "" : lower_case(*value);
    return space == "left-anterior-superior" || space == "las" || space == "3d-left-handed";
}

/// Voxels are shown in the order of the file, along their own axes; what that changes is said.
void warn_of_orientation(VolumeInfo& info, const glm::dmat3& directions, bool left_handed)
{
    bool is_oblique = false;
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 unit = glm::normalize(directions[axis]);
        if (std::abs(unit[axis]) < 1.0 - 1e-9) {
            is_oblique = true;
        } else if (unit[axis] < 0.0) {
            info.warnings.push_back(sentence("axis ", "xyz"[axis],
                                             " runs against its space direction; voxels are kept in ",
                                             "the order of the file"));
        }
    }
    if (is_oblique) {
        info.warnings.emplace_back("space directions are oblique; the volume is shown along its own axes");
    }
    if ((glm::determinant(directions) < 0.0) != left_handed) {
        info.warnings.emplace_back("axes are left-handed; the volume is shown as its mirror image");
    }
}

void read_spacing(const HeaderFields& fields, VolumeInfo& info)
{
    std::optional<glm::dvec3> spacing;
    if (fields.has("space directions")) {
        const glm::dmat3 directions = space_directions(fields);
        spacing = glm::dvec3(glm::length(directions[0]), glm::length(directions[1]), glm::length(directions[2]));
        warn_of_orientation(info, directions, space_is_left_handed(fields));
    } else if (fields.has("spacings")) {
        const std::vector<double> numbers = fields.numbers("spacings", 3);
        // "nan" is how NRRD says that it does not know.
        if (!(std::isnan(numbers[0]) && std::isnan(numbers[1]) && std::isnan(numbers[2]))) {
            for (int axis = 0; axis < 3; ++axis) {
                const double number = numbers[static_cast<size_t>(axis)];
                if (!std::isfinite(number) || number == 0.0) fields.refuse("spacings", "3 finite numbers other than 0");
                if (number < 0.0) {
                    info.warnings.push_back(sentence("spacing along ", "xyz"[axis], " is negative; voxels are kept in ",
                                                     "the order of the file"));
                }
            }
            spacing = glm::abs(glm::dvec3(numbers[0], numbers[1], numbers[2]));
        }
    }
    apply_spacing(info, spacing, unit_of(fields), "mm");
}

bool is_pattern(std::string_view data_file)
{
    return data_file.find('%') != std::string_view::npos && words_of(data_file).size() >= 4;
}

/// Where the bytes begin that follow `lines` line ends counted from `from`.
int64_t skip_lines(const HeaderFields& fields, const std::filesystem::path& file, int64_t from, int64_t lines)
{
    if (lines == 0) return from;
    const std::string head = read_head(file, static_cast<size_t>(LINE_SKIP_BYTES));
    auto at = static_cast<size_t>(from);
    for (int64_t line = 0; line < lines; ++line) {
        const size_t end = at < head.size() ? head.find('\n', at) : std::string::npos;
        if (end == std::string::npos) {
            fields.refuse(fields.has("line skip") ? "line skip" : "lineskip",
                          sentence("at most the ", line, " lines in the first 16 MiB of ", file.filename().string()));
        }
        at = end + 1;
    }
    return static_cast<int64_t>(at);
}

RawVoxels place_voxels(const Header& header, VoxelType type)
{
    const HeaderFields& fields = header.fields;
    RawVoxels voxels{.file = fields.path(), .offset_bytes = header.voxels_at};
    const char* const data_file = fields.has("datafile") ? "datafile" : "data file";
    if (const std::string* stated = fields.find(data_file)) {
        if (stated->starts_with("LIST") || is_pattern(*stated)) {
            fields.refuse(data_file, "one file: voxels spread over several files are not supported yet");
        }
        voxels.file = fields.data_file(data_file);
        voxels.offset_bytes = 0;
    } else if (!header.is_attached) {
        fail(fields.path().string(), ": ends without \"data file\" and without the empty line before voxels; expected ",
             "one of them");
    }

    const std::string encoding = lower_case(fields.required("encoding", "raw"));
    if (encoding != "raw") {
        fail(fields.path().string(), ": encoding ", in_quotes(encoding), " is not supported yet; expected raw");
    }
    if (bytes_of(type) > 1) {
        const std::string endian = lower_case(fields.required("endian", "little or big"));
        if (endian != "little" && endian != "big") fields.refuse("endian", "little or big");
        voxels.big_endian = endian == "big";
    }

    constexpr int64_t MOST = int64_t{1} << 62;
    const char* const line_skip = fields.has("lineskip") ? "lineskip" : "line skip";
    const char* const byte_skip = fields.has("byteskip") ? "byteskip" : "byte skip";
    const int64_t bytes = fields.whole(byte_skip, 0, -1, MOST);
    const int64_t lines = fields.whole(line_skip, 0, 0, MOST);
    voxels.offset_bytes = bytes == RawVoxels::AT_END
                              ? RawVoxels::AT_END
                              : skip_lines(fields, voxels.file, voxels.offset_bytes, lines) + bytes;
    return voxels;
}

}  // namespace

std::unique_ptr<VolumeSource> open_nrrd(const std::filesystem::path& path, const OpenOptions& /*options*/)
{
    const std::string extension = lower_case(path.extension().string());
    if (!read_head(path, 4).starts_with("NRRD") && extension != ".nrrd" && extension != ".nhdr") return nullptr;

    const Header header = read_header(path, read_head(path));
    const HeaderFields& fields = header.fields;
    fields.required("dimension", "3");
    fields.whole("dimension", 3, 3, 3);
    VolumeInfo info{.name = path.filename().string(), .format = "nrrd"};
    info.size = fields.size("sizes");
    info.type = fields.type("type");
    read_spacing(fields, info);
    const RawVoxels voxels = place_voxels(header, info.type);
    return open_raw_voxels(std::move(info), voxels);
}

}  // namespace shvr
