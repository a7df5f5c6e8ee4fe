// Opens raw voxels with the help of files next to them. For scan.raw, these are tried in the following order:
//   scan.json, scan.raw.json   our own: {"size": [x,y,z], "type": "int16", "endian": "little", "offset": 0,
//                              "spacing": [x,y,z], "unit": "um"}; size and type are required
//   scan.nhdr, scan.mhd        if they name this file
//   scan.dat, scan.raw.dat     NSI's and Inviwo's text ("Resolution: ...") or Dragonfly's XML, as the scanner wrote it
//   scan.vol.info, scan.vgi, scan.xtekct   headers of CT scanners: PyHST, VGStudio, Nikon
//   scan_512x512x300_16bit.raw the file's own name; the type may be missing if the file's size determines it
// Opening a .json, a .dat or a scanner's header itself opens its voxels.

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/orientation.h"
#include "engine/formats/raw/side_cars.h"
#include "engine/formats/readers.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Source = std::unique_ptr<VolumeSource>;

Source open_side_car(SideCar side_car)
{
    side_car.info.name = side_car.voxels.file.filename().string();
    side_car.info.format = "raw";
    return right_handed(open_raw_voxels(std::move(side_car.info), side_car.voxels));
}

fs::path with_extension(fs::path path, const char* extension)
{
    return path.replace_extension(extension);
}

fs::path with_suffix(fs::path path, const char* suffix)
{
    return path += suffix;
}

/// Returns null if the document is no side-car, but, for example, another program's settings.
std::optional<JsonDocument> parse_json(const fs::path& path)
{
    JsonDocument document = read_json(path, MAX_HEADER_BYTES, {.depth = 64, .expected = "size and type"});
    if (!document.root().is_object() || document.root()["shvr_session"].exists()) return {};
    return document;
}

bool is_same_file(const fs::path& a, const fs::path& b)
{
    std::error_code error;
    return fs::equivalent(a, b, error) && !error;
}

/// Opens `raw` by the header next to it. Returns null if the header does not refer to `raw`.
Source open_by_header(const fs::path& header, const char* data_field, const fs::path& raw,
                      Source (*open)(const fs::path&, const OpenOptions&))
{
    if (!is_file(header)) return nullptr;
    std::string_view text;
    const std::string head = read_head(header);
    for (text = head; !text.empty();) {
        const std::string_view line = take_line(text);
        const size_t separator = line.find_first_of(":=");
        if (separator == std::string_view::npos || lower_case(trimmed(line.substr(0, separator))) != data_field)
            continue;
        const fs::path stated = header.parent_path() / std::string(trimmed(line.substr(separator + 1)));
        return is_same_file(stated, raw) ? open(header, {}) : nullptr;
    }
    return nullptr;
}

Source open_bare(const fs::path& raw)
{
    for (const fs::path& path : {with_extension(raw, ".json"), with_suffix(raw, ".json")}) {
        if (!is_file(path)) continue;
        if (const auto document = parse_json(path)) return open_side_car(read_json_side_car(*document, raw));
    }
    const fs::path nhdr = with_extension(raw, ".nhdr");
    for (const char* field : {"data file", "datafile"}) {
        if (Source source = open_by_header(nhdr, field, raw, open_nrrd)) return source;
    }
    if (Source source = open_by_header(with_extension(raw, ".mhd"), "elementdatafile", raw, open_mhd)) return source;
    for (const fs::path& path : {with_extension(raw, ".dat"), with_suffix(raw, ".dat")}) {
        if (path == raw || !is_file(path)) continue;
        if (auto side_car = read_dat_side_car(path, raw)) return open_side_car(std::move(*side_car));
    }
    if (auto side_car = find_scanner_header(raw)) return open_side_car(std::move(*side_car));
    if (auto side_car = read_file_name(raw)) return open_side_car(std::move(*side_car));
    return nullptr;
}

}  // namespace

Source open_raw_with_side_car(const fs::path& path, const OpenOptions& /*options*/)
{
    const std::string extension = lower_case(path.extension().string());
    if (extension == ".json") {
        const std::optional<JsonDocument> document = parse_json(path);
        if (!document) return nullptr;
        const fs::path named = with_extension(path, "");  // scan.raw.json
        const fs::path raw = named.has_extension() && is_file(named) ? named : with_extension(path, ".raw");
        return open_side_car(read_json_side_car(*document, raw));
    }
    if (is_scanner_header(path)) return open_side_car(read_scanner_header(path, {}));
    if (extension == ".dat") {
        if (auto side_car = read_dat_side_car(path, {})) return open_side_car(std::move(*side_car));
    }
    for (const char* bare : {"", ".raw", ".bin", ".vol", ".dat"}) {
        if (extension != bare) continue;
        if (Source source = open_bare(path)) return source;
    }
    if (extension == ".raw") {
        fail(path.string(),
             ": holds bare voxels, and no file beside it states their size and type; expected --raw WxHxD:TYPE, ",
             "as in --raw 512x512x300:uint16:little:0");
    }
    return nullptr;
}

}  // namespace shvr
