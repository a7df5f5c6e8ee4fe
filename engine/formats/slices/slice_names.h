#pragma once
// The files of a folder that are the slices of one volume, in the order of the numbers in their names. Two series in
// one folder are refused rather than separated by guessing; a single odd picture next to a series, such as a preview,
// is left out. Any thread may call these.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shvr {

inline constexpr size_t MAX_SLICES = size_t{1} << 20;

/// A file's name without its extension, split up: "Slice_007b" is "slice_/b" and "007". No name holds a slash.
struct SliceName {
    std::string file;
    std::string pattern;
    std::vector<std::string> digits;   ///< as written
    std::vector<std::string> numbers;  ///< without leading zeros
};

/// The names in a folder with one of these extensions, in lower case; `kind`: "TIFFs", for messages. At most
/// MAX_SLICES.
std::vector<SliceName> slice_names_in(const std::filesystem::path& folder, std::span<const std::string_view> extensions,
                                      const char* kind);

/// Whether the picture in the first file has another size than that in the second.
using DiffersInSize = std::function<bool(const std::string& a, const std::string& b)>;
/// Brings names of one series into order and drops pictures that belong to none: a single name of its own pattern with
/// fewer numbers, or of another size. `warnings` name those, and gaps in the numbering, since slices are drawn evenly
/// spaced. Fails if there are several series, or names without numbers.
void order_slices(const std::filesystem::path& folder, const char* kind, const DiffersInSize& differs,
                  std::vector<SliceName>& names, std::vector<std::string>& warnings);

/// Formats of slices, and how many files of each a folder holds: the slices are of the one with most files.
enum class SliceFormat { tiff, png, bmp, jpeg };
inline constexpr SliceFormat SLICE_FORMATS[] = {SliceFormat::tiff, SliceFormat::png, SliceFormat::bmp,
                                                SliceFormat::jpeg};
std::span<const std::string_view> extensions_of(SliceFormat format);
/// Null if the folder holds none. Of equally many, the first in the order above.
std::optional<SliceFormat> main_slice_format(const std::filesystem::path& folder);

}  // namespace shvr
