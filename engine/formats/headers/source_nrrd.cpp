// Opens NRRD, versions 1 to 6 (http://teem.sourceforge.net/nrrd/format.html). Voxels may be raw or compressed with
// gzip, and in the header's own file, in another file, or in several files.

#include <utility>

#include "engine/base/error.h"
#include "engine/formats/data_files.h"
#include "engine/formats/headers/nrrd_axes.h"
#include "engine/formats/orientation.h"
#include "engine/formats/raw/source_raw.h"
#include "engine/formats/readers.h"

namespace shvr {
namespace {

constexpr int64_t LINE_SKIP_BYTES = int64_t{16} << 20;

struct NrrdHeader {
    HeaderFields fields;
    bool is_attached = false;
    int64_t voxels_at = 0;         ///< offset of the first byte after the empty line that ends the header
    std::string_view file_list{};  ///< the lines after "data file: LIST"
    bool states_groups = false;    ///< a mask of this program, or segments of 3D Slicer
    bool states_offsets = false;   ///< density offsets of this program
};

/// Records key/value pairs that mark the file as a mask or as density offsets rather than a scan.
void note_content(std::string_view pair, NrrdHeader& header)
{
    header.states_groups |= pair == "shvr_content:=mask" || pair.starts_with("Segment0_");
    header.states_offsets |= pair == "shvr_content:=offsets";
}

NrrdHeader read_nrrd_header(const std::filesystem::path& path, const std::string& head)
{
    NrrdHeader header{HeaderFields(path)};
    std::string_view rest = head;
    const std::string_view magic = take_line(rest);
    if (magic.size() != 8 || !magic.starts_with("NRRD000") || magic[7] < '1' || magic[7] > '6') {
        fail(path.string(), ": begins with ", in_quotes(magic.substr(0, 8)), "; expected NRRD0001 to NRRD0006");
    }
    for (int line_number = 2; !rest.empty(); ++line_number) {
        const std::string_view line = take_line(rest);
        if (line.empty()) {
            header.is_attached = true;
            header.voxels_at = int64_t(head.size() - rest.size());
            break;
        }
        if (line.starts_with('#')) continue;
        const size_t colon = line.find(':');
        if (colon == std::string_view::npos) {
            fail(path.string(), ": line ", line_number, " is ", in_quotes(line), "; expected \"field: value\"");
        }
        if (line.substr(colon).starts_with(":=")) {
            note_content(trimmed(line), header);
            continue;
        }
        const std::string name = lower_case(trimmed(line.substr(0, colon)));
        header.fields.add(name, line.substr(colon + 1));
        if ((name == "data file" || name == "datafile") && is_list(line.substr(colon + 1))) {
            header.file_list = rest;  // the last field: names follow
            break;
        }
    }
    return header;
}

/// Returns the offset after the next `lines` line ends, searched from offset `from`.
int64_t skip_lines(const HeaderFields& fields, const std::filesystem::path& file, int64_t from, int64_t lines)
{
    if (lines == 0) return from;
    const std::string head = read_head(file, size_t(LINE_SKIP_BYTES));
    auto at = size_t(from);
    for (int64_t line = 0; line < lines; ++line) {
        const size_t end = at < head.size() ? head.find('\n', at) : std::string::npos;
        if (end == std::string::npos) {
            fields.refuse(fields.has("line skip") ? "line skip" : "lineskip",
                          sentence("at most the ", line, " lines in the first 16 MiB of ", file.filename().string()));
        }
        at = end + 1;
    }
    return int64_t(at);
}

bool is_deflated(const HeaderFields& fields)
{
    const std::string encoding = lower_case(fields.required("encoding", "raw or gzip"));
    if (encoding == "gzip" || encoding == "gz") return true;
    if (encoding == "raw") return false;
    const bool is_known = encoding == "bzip2" || encoding == "bz2" || encoding == "ascii" || encoding == "text" ||
                          encoding == "txt" || encoding == "hex";
    fail(fields.path().string(), ": encoding ", in_quotes(encoding), is_known ? " is not supported" : " is unknown",
         "; expected raw or gzip");
}

bool is_big_endian(const HeaderFields& fields, VoxelType type)
{
    if (bytes_of(type) == 1) return false;
    const std::string endian = lower_case(fields.required("endian", "little or big"));
    if (endian != "little" && endian != "big") fields.refuse("endian", "little or big");
    return endian == "big";
}

/// Locates the voxels in one file by skipping the lines and bytes that the header states for every file.
RawVoxels::Part place_in(const HeaderFields& fields, const std::filesystem::path& file, int64_t from, bool deflated)
{
    constexpr int64_t MOST = int64_t{1} << 62;
    const char* const byte_skip = fields.has("byteskip") ? "byteskip" : "byte skip";
    const char* const line_skip = fields.has("lineskip") ? "lineskip" : "line skip";
    // Byte skip -1, not allowed with compression, means the file's last bytes. Lines are skipped before decompression.
    const int64_t bytes = fields.whole(byte_skip, 0, deflated ? 0 : -1, MOST);
    if (bytes == RawVoxels::AT_END) return {file, RawVoxels::AT_END};
    const int64_t begin = skip_lines(fields, file, from, fields.whole(line_skip, 0, 0, MOST));
    return {file, deflated ? begin : begin + bytes};
}

RawVoxels place_voxels(const NrrdHeader& header, const VolumeInfo& info)
{
    const HeaderFields& fields = header.fields;
    RawVoxels voxels;
    voxels.is_deflated = is_deflated(fields);
    voxels.big_endian = is_big_endian(fields, info.type);
    const char* const data_file = fields.has("datafile") ? "datafile" : "data file";
    const std::string* stated = fields.find(data_file);
    if (stated == nullptr && !header.is_attached) {
        fail(fields.path().string(), ": has neither a data file nor an empty line followed by voxels; ",
             "expected one of them");
    }
    if (stated != nullptr && (is_list(*stated) || is_pattern(*stated))) {
        for (const auto& file : data_files(fields, data_file, header.file_list, info.size)) {
            voxels.parts.push_back(place_in(fields, file, 0, voxels.is_deflated));
        }
    } else {
        const RawVoxels::Part part = stated == nullptr
                                         ? place_in(fields, fields.path(), header.voxels_at, voxels.is_deflated)
                                         : place_in(fields, fields.data_file(data_file), 0, voxels.is_deflated);
        voxels.file = part.file;
        voxels.offset_bytes = part.offset_bytes;
    }
    if (voxels.is_deflated) {
        voxels.skip_bytes = fields.whole(fields.has("byteskip") ? "byteskip" : "byte skip", 0, 0, INT64_MAX);
    }
    return voxels;
}

/// Warns if the file states a former range of values, as writers do that quantize values (teem's "unu quantize"). The
/// range is only reported, since the stored numbers may be the intended values.
void warn_of_old_range(const HeaderFields& fields, VolumeInfo& info)
{
    for (const auto& [lower, upper] : {std::pair{"old min", "old max"}, std::pair{"oldmin", "oldmax"}}) {
        if (!fields.has(lower) && !fields.has(upper)) continue;
        const auto stated = [&](const char* name) { return fields.has(name) ? *fields.find(name) : "not stated"; };
        info.warnings.push_back(sentence("its values were quantized: ", lower, " is ", printable(stated(lower)),
                                         " and ", upper, " ", printable(stated(upper)),
                                         "; intensities are those stored"));
    }
}

/// Moves the start of the voxels to the chosen time point.
void choose_frame(const HeaderFields& fields, int64_t frame, int64_t frames, const VolumeInfo& info, RawVoxels& voxels)
{
    if (frames == 1) return;
    if (!voxels.parts.empty() || voxels.offset_bytes == RawVoxels::AT_END) {
        fields.refuse("dimension", "3: time points in several files, or counted from the end, are not supported");
    }
    int64_t bytes = 0;
    int64_t all = 0;
    if (__builtin_mul_overflow(voxel_count(info), int64_t(bytes_of(info.type)), &bytes) ||
        __builtin_mul_overflow(bytes, frames, &all) ||
        __builtin_add_overflow(all, voxels.is_deflated ? voxels.skip_bytes : voxels.offset_bytes, &all)) {
        fields.refuse("sizes", "sizes whose voxels fit in 2^63 bytes");
    }
    (voxels.is_deflated ? voxels.skip_bytes : voxels.offset_bytes) += frame * bytes;
    voxels.bytes_after = (frames - 1 - frame) * bytes;
}

}  // namespace

std::unique_ptr<VolumeSource> open_nrrd(const std::filesystem::path& path, const OpenOptions& options)
{
    const std::string extension = lower_case(path.extension().string());
    if (!read_head(path, 4).starts_with("NRRD") && extension != ".nrrd" && extension != ".nhdr") return nullptr;

    const std::string head = read_head(path);
    const NrrdHeader header = read_nrrd_header(path, head);
    const HeaderFields& fields = header.fields;
    VolumeInfo info{.name = path.filename().string(), .format = "nrrd"};
    const NrrdAxes axes = read_nrrd_axes(fields);
    info.size = axes.size;
    const auto [type, number] = fields.type_or_wide("type");
    info.type = type;
    read_nrrd_space(fields, axes, info);
    warn_of_old_range(fields, info);
    if (header.states_groups) warn_of_content(info.warnings, "mask");
    if (header.states_offsets) warn_of_content(info.warnings, "offsets");
    RawVoxels voxels = place_voxels(header, info);
    voxels.channels = axes.channels;
    voxels.channel = chosen_channel(path.string(), options, axes.channels,
                                    axes.channels_are_colors ? color_names(axes.channels) : color_names(0));
    choose_frame(fields, chosen_frame(path.string(), options, axes.frames), axes.frames, info, voxels);
    return right_handed(widened(open_raw_voxels(std::move(info), voxels), number, path.string()));
}

}  // namespace shvr
