// Opens raw voxels in a layout given by the user: in one file, or one slice per file, numbered as scanners and toolkits
// do (head.1, head.2, ... or slice000.raw, slice001.raw, ...).

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/open_volume.h"
#include "engine/formats/raw/source_raw.h"
#include "engine/formats/voxel_bytes.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

/// Compares digits as numbers: "slice2" comes before "slice10".
bool comes_before(const std::string& a, const std::string& b)
{
    size_t i = 0;
    size_t j = 0;
    while (i < a.size() && j < b.size()) {
        if (!is_digit(a[i]) || !is_digit(b[j])) {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i, ++j;
            continue;
        }
        const auto number_at = [](const std::string& text, size_t& at) {
            while (at + 1 < text.size() && text[at] == '0' && is_digit(text[at + 1])) ++at;
            const size_t begin = at;
            while (at < text.size() && is_digit(text[at])) ++at;
            return std::string_view(text).substr(begin, at - begin);
        };
        const std::string_view left = number_at(a, i);
        const std::string_view right = number_at(b, j);
        if (left != right) return left.size() != right.size() ? left.size() < right.size() : left < right;
    }
    return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

/// Returns the size of a file with one slice, including `layout.offset_bytes`; null if it exceeds 63 bits.
std::optional<int64_t> slice_file_bytes(const RawLayout& layout)
{
    int64_t bytes = 0;
    if (__builtin_mul_overflow(layout.size.x * layout.size.y, int64_t(bytes_of(layout.type)), &bytes) ||
        __builtin_add_overflow(bytes, layout.offset_bytes, &bytes)) {
        return {};
    }
    return bytes;
}

int64_t file_bytes(const fs::path& path)
{
    std::error_code error;
    const uintmax_t bytes = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
    return error ? 0 : int64_t(bytes);
}

/// Returns the files of exactly `bytes` bytes in a folder, sorted by name. Fails unless there is one for each slice.
std::vector<fs::path> slices_in(const fs::path& folder, const RawLayout& layout, int64_t bytes)
{
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (name.starts_with('.') || file_bytes(at->path()) != bytes) continue;
        names.push_back(name);
    }
    if (error) fail(folder.string(), ": cannot be read: ", error.message());
    if (int64_t(names.size()) != layout.size.z) {
        fail(folder.string(), ": is a folder with ", names.size(), " files of ", bytes, " bytes; expected ",
             layout.size.z, " files, one for each slice");
    }
    std::sort(names.begin(), names.end(), comes_before);
    std::vector<fs::path> slices;
    for (const std::string& name : names) slices.push_back(folder / name);
    return slices;
}

/// Returns the files of `count` slices, one slice each, by counting on from the last number in the name of `first`.
/// `bytes` is the size of each file. Empty if that name contains no digits.
std::vector<fs::path> slices_from(const fs::path& first, int64_t count, int64_t bytes)
{
    const std::string name = first.filename().string();
    size_t end = name.size();
    while (end > 0 && !is_digit(name[end - 1])) --end;
    size_t begin = end;
    while (begin > 0 && is_digit(name[begin - 1])) --begin;
    const std::optional<int64_t> number = whole_of(name.substr(begin, end - begin));
    if (!number || *number > INT64_MAX - count) return {};
    std::vector<fs::path> slices;
    for (int64_t i = 0; i < count; ++i) {
        std::string digits = std::to_string(*number + i);
        if (digits.size() < end - begin) digits.insert(0, end - begin - digits.size(), '0');
        slices.push_back(first.parent_path() / (name.substr(0, begin) + digits + name.substr(end)));
        if (const InputFile slice = open_input_file(slices.back()); slice.bytes != bytes) {
            fail(slice.path.string(), ": holds ", slice.bytes, " bytes; expected ", bytes,
                 ", the size of one slice, as in ", name);
        }
    }
    return slices;
}

}  // namespace

std::unique_ptr<VolumeSource> open_raw(const fs::path& path, const RawLayout& layout)
{
    VolumeInfo info{.name = path.filename().string(), .format = "raw", .size = layout.size, .type = layout.type};
    const bool stated = layout.spacing != glm::dvec3(1.0) || layout.unit != "voxel";
    apply_spacing(info, stated ? std::optional(layout.spacing) : std::nullopt, layout.unit, "voxel");
    static_cast<void>(voxel_count(info));

    RawVoxels voxels{.file = path, .offset_bytes = layout.offset_bytes, .big_endian = layout.big_endian};
    std::error_code ignored;
    const std::optional<int64_t> bytes = slice_file_bytes(layout);
    std::vector<fs::path> slices;
    if (bytes && fs::is_directory(path, ignored)) {
        slices = slices_in(path, layout, *bytes);
    } else if (bytes && layout.size.z > 1 && file_bytes(path) == *bytes) {
        slices = slices_from(path, layout.size.z, *bytes);
    }
    if (slices.size() > 1) {
        info.warnings.push_back(sentence(slices.size(), " files, ", slices.front().filename().string(), " to ",
                                         slices.back().filename().string(), ", were read as slices"));
    }
    for (const fs::path& slice : slices) voxels.parts.push_back({slice, layout.offset_bytes});
    return open_raw_voxels(std::move(info), voxels);
}

}  // namespace shvr
