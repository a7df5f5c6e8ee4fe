// Opens raw voxels whose file name states size and type, with a warning that both are a guess.

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/raw/side_cars.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

/// Parses a size such as "512x512x300" at the start of `text`; returns its length in characters, or 0.
size_t size_in_name(std::string_view text, Size3& size)
{
    size_t at = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0 && (at >= text.size() || (text[at++] | 0x20) != 'x')) return 0;
        const size_t first = at;
        while (at < text.size() && is_digit(text[at])) ++at;
        const std::optional<int64_t> side = whole_of(text.substr(first, at - first));
        if (!side) return 0;
        size[axis] = *side;
    }
    return at;
}

/// Reads words like "16bit", "int16" or "uint16le", and sets the type and the byte order that they name.
void type_in_name(std::string word, std::optional<VoxelType>& type, std::optional<bool>& big_endian)
{
    if (word == "little" || word == "big") big_endian = word == "big";
    if (word.ends_with("le") || word.ends_with("be")) {
        big_endian = word.ends_with("be");
        word.resize(word.size() - 2);
    }
    if (word == "8bit") type = VoxelType::uint8;
    if (word == "16bit") type = VoxelType::uint16;
    if (word == "32bit") type = VoxelType::float32;
    if (word == "64bit") type = VoxelType::float64;
    // Everyday words that are also type names ("short_root.raw") are not taken as types.
    if (!word.empty() && (is_digit(word.back()) || word == "uchar" || word == "ushort" || word == "uint")) {
        if (const auto known = voxel_type_of(word)) type = known;
    }
}

/// Returns the voxel type with which the voxels would exactly fill the file. Fails if there is none.
VoxelType type_by_length(const fs::path& path, const VolumeInfo& info)
{
    const int64_t count = voxel_count(info);
    std::error_code error;
    const auto bytes = int64_t(fs::file_size(path, error));
    for (const VoxelType type : {VoxelType::uint8, VoxelType::uint16, VoxelType::float32, VoxelType::float64}) {
        if (!error && bytes % count == 0 && size_t(bytes / count) == bytes_of(type)) return type;
    }
    fail(path.string(), ": holds ", bytes, " bytes, which is not 1, 2, 4 or 8 for each of the ", count,
         " voxels that its name states; expected --raw WxHxD:TYPE");
}

}  // namespace

std::optional<SideCar> read_file_name(const fs::path& raw)
{
    const std::string stem = raw.stem().string();
    std::string words;
    SideCar found{.voxels = {.file = raw}};
    bool has_size = false;
    for (size_t at = 0; at < stem.size();) {
        const bool starts_number = is_digit(stem[at]) && (at == 0 || !is_digit(stem[at - 1]));
        const size_t length =
            starts_number && !has_size ? size_in_name(std::string_view(stem).substr(at), found.info.size) : 0;
        has_size |= length > 0;
        words += length > 0 || std::string_view("_-. ()[]").find(stem[at]) != std::string_view::npos ? ' ' : stem[at];
        at += std::max<size_t>(1, length);
    }
    if (!has_size) return {};
    std::optional<VoxelType> type;
    std::optional<bool> big_endian;
    for (const std::string_view word : words_of(words)) type_in_name(lower_case(word), type, big_endian);

    found.info.name = raw.string();
    found.info.type = type ? *type : type_by_length(raw, found.info);
    found.voxels.big_endian = big_endian;
    found.info.warnings.push_back(sentence("size ", found.info.size.x, "x", found.info.size.y, "x", found.info.size.z,
                                           " and type ", name_of(found.info.type),
                                           " were inferred from the file name"));
    apply_spacing(found.info, {}, {}, "voxel");
    return found;
}

}  // namespace shvr
