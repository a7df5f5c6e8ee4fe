#pragma once
// Finds the slices of one volume among the files of a folder, and sorts them by the numbers in their names. Two series
// in one folder are refused rather than separated by guessing. A single odd picture next to a series, such as a
// preview, is left out. Any thread may call these.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shvr {

inline constexpr size_t MAX_SLICES = size_t{1} << 20;

/// A file's name without its extension, split up: "Slice_007b" has the pattern "slice_/b" and the digits "007".
struct SliceName {
    std::string file;
    std::string pattern;
    std::vector<std::string> digits;   ///< as written
    std::vector<std::string> numbers;  ///< without leading zeros
};

/// Returns the names of files in `folder` with one of these extensions, which are in lower case; at most MAX_SLICES.
/// `kind` is the name of such files in messages, as in "TIFFs".
std::vector<SliceName> slice_names_in(const std::filesystem::path& folder, std::span<const std::string_view> extensions,
                                      const char* kind);

/// Whether the picture in the first file differs in size from the picture in the second.
using DiffersInSize = std::function<bool(const std::string& a, const std::string& b)>;
/// Sorts the names of one series, and drops pictures outside the series: a single name with a pattern of its own, and
/// with fewer numbers or another picture size. Adds `warnings` about dropped pictures, and about gaps in the numbering,
/// since slices are drawn evenly spaced. Fails if there are several series, or names without numbers.
void order_slices(const std::filesystem::path& folder, const char* kind, const DiffersInSize& differs,
                  std::vector<SliceName>& names, std::vector<std::string>& warnings);

/// Formats of slices. If a folder holds several formats, the format with the most files is taken.
enum class SliceFormat { tiff, png, bmp, jpeg };
inline constexpr SliceFormat SLICE_FORMATS[] = {SliceFormat::tiff, SliceFormat::png, SliceFormat::bmp,
                                                SliceFormat::jpeg};
std::span<const std::string_view> extensions_of(SliceFormat format);
/// Returns the format with the most files; of equally frequent formats, the first in the order above; null if none.
std::optional<SliceFormat> main_slice_format(const std::filesystem::path& folder);

}  // namespace shvr
