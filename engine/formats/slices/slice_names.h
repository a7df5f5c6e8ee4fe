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

/// A file's name without its extension, split up: "Slice_007b" becomes "slice_/b" and "007". Names contain no slash.
struct SliceName {
    std::string file;
    std::string pattern;
    std::vector<std::string> digits;   ///< as written
    std::vector<std::string> numbers;  ///< without leading zeros
};

/// The names of files in `folder` with one of these extensions, which are in lower case. `kind` names such files in
/// messages, as in "TIFFs". At most MAX_SLICES.
std::vector<SliceName> slice_names_in(const std::filesystem::path& folder, std::span<const std::string_view> extensions,
                                      const char* kind);

/// Whether the picture in the first file differs in size from the picture in the second.
using DiffersInSize = std::function<bool(const std::string& a, const std::string& b)>;
/// Sorts the names of one series and drops pictures that belong to no series: a single name of its own pattern with
/// fewer numbers, or with another picture size. Adds `warnings` that name the dropped pictures, and warnings about gaps
/// in the numbering, since slices are drawn evenly spaced. Fails if there are several series, or names without numbers.
void order_slices(const std::filesystem::path& folder, const char* kind, const DiffersInSize& differs,
                  std::vector<SliceName>& names, std::vector<std::string>& warnings);

/// Formats of slices. If a folder holds files of several formats, the slices are of the format with the most files.
enum class SliceFormat { tiff, png, bmp, jpeg };
inline constexpr SliceFormat SLICE_FORMATS[] = {SliceFormat::tiff, SliceFormat::png, SliceFormat::bmp,
                                                SliceFormat::jpeg};
std::span<const std::string_view> extensions_of(SliceFormat format);
/// The format with the most files; of equally frequent formats, the first in the order above. Null if there is none.
std::optional<SliceFormat> main_slice_format(const std::filesystem::path& folder);

}  // namespace shvr
