#include "engine/formats/slices/slice_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

SliceName taken_apart(const fs::path& path)
{
    SliceName name{path.filename().string()};
    const std::string stem = lower_case(path.stem().string());
    for (size_t at = 0; at < stem.size();) {
        if (!is_digit(stem[at])) {
            name.pattern += stem[at++];
            continue;
        }
        const size_t first = at;
        const size_t begin = std::min(stem.find_first_not_of('0', at), stem.size());
        while (at < stem.size() && is_digit(stem[at])) ++at;
        name.pattern += '/';
        name.digits.push_back(stem.substr(first, at - first));
        name.numbers.push_back(stem.substr(std::min(begin, at), at - std::min(begin, at)));
    }
    return name;
}

/// Compares numbers of any length, given as digits without leading zeros, perhaps with a decimal point and fraction.
bool is_less(const std::string& a, const std::string& b)
{
    const size_t whole_a = std::min(a.find('.'), a.size()), whole_b = std::min(b.find('.'), b.size());
    return whole_a != whole_b ? whole_a < whole_b : a < b;
}

bool comes_before(const SliceName& a, const SliceName& b)
{
    if (a.pattern != b.pattern) return a.pattern < b.pattern;
    for (size_t i = 0; i < a.numbers.size(); ++i) {
        if (a.numbers[i] != b.numbers[i]) return is_less(a.numbers[i], b.numbers[i]);
    }
    return a.file < b.file;
}

/// Joins the two numbers around the point in names like "z_8.5" into one decimal number. All names must have the same
/// pattern. Returns null unless the pattern has exactly one such point.
std::optional<std::vector<SliceName>> with_decimals(std::vector<SliceName> names)
{
    const std::string& pattern = names.front().pattern;
    const size_t point = pattern.find("/./");
    if (point == std::string::npos || pattern.find("/./", point + 1) != std::string::npos) return std::nullopt;
    const auto whole = size_t(std::count(pattern.begin(), pattern.begin() + std::ptrdiff_t(point), '/'));
    const std::string joined = pattern.substr(0, point) + pattern.substr(point + 2);
    for (SliceName& name : names) {
        std::string fraction = name.digits[whole + 1];
        fraction.erase(fraction.find_last_not_of('0') + 1);
        name.pattern = joined;
        if (!fraction.empty()) name.numbers[whole] += "." + fraction;
        name.numbers.erase(name.numbers.begin() + std::ptrdiff_t(whole) + 1);
        name.digits.erase(name.digits.begin() + std::ptrdiff_t(whole) + 1);
    }
    std::sort(names.begin(), names.end(), comes_before);
    return names;
}

/// Returns the index of the number that counts the slices: the first number that increases from each file to the next.
/// Null if there is none, because the names belong to several series.
std::optional<size_t> counting_number(const std::vector<SliceName>& names)
{
    for (size_t number = 0; number < names.front().numbers.size(); ++number) {
        const auto falls = [&](const SliceName& a, const SliceName& b) {
            return !is_less(a.numbers[number], b.numbers[number]);
        };
        if (std::adjacent_find(names.begin(), names.end(), falls) == names.end()) return number;
    }
    return {};
}

/// Returns a key for the name's series: its pattern, and its numbers before the last one that differs.
std::string series_of(const SliceName& name, size_t last_number)
{
    std::string series = name.pattern;
    for (size_t i = 0; i < last_number; ++i) series += "," + name.numbers[i];
    return series;
}

/// If only one pattern has several files, removes the files of other patterns, which are single pictures, not slices.
void remove_odd_pictures(const DiffersInSize& differs, std::vector<SliceName>& names,
                         std::vector<std::string>& warnings)
{
    std::map<std::string, std::vector<const SliceName*>> patterns;
    for (const SliceName& name : names) patterns[name.pattern].push_back(&name);
    const SliceName* main = nullptr;
    for (const auto& [pattern, of_pattern] : patterns) {
        if (of_pattern.size() < 2) continue;
        if (main) return;
        main = of_pattern.front();
    }
    if (!main || patterns.size() < 2) return;
    std::string odd;
    for (const auto& [pattern, of_pattern] : patterns) {
        const SliceName& name = *of_pattern.front();
        if (pattern == main->pattern) continue;
        if (name.numbers.size() >= main->numbers.size() && !differs(name.file, main->file)) return;
        odd += (odd.empty() ? "" : ", ") + in_quotes(name.file);
    }
    warnings.push_back(sentence(odd, patterns.size() > 2 ? " are" : " is",
                                " not numbered like the slices or of another "
                                "size, and left out"));
    const std::string kept = main->pattern;
    std::erase_if(names, [&](const SliceName& name) { return name.pattern != kept; });
}

/// Returns the index of the number that counts the slices. Fails if the names belong to several series.
size_t check_one_series(const fs::path& folder, const char* kind, std::vector<SliceName>& names)
{
    const bool is_one_pattern = names.front().pattern == names.back().pattern;
    if (is_one_pattern && names.front().numbers.empty()) {
        fail(folder.string(), ": ", in_quotes(names.front().file), " and ", in_quotes(names.back().file),
             " differ only in their extension; expected one of them: remove the other");
    }
    if (is_one_pattern) {
        if (const std::optional<size_t> number = counting_number(names)) return *number;
        if (std::optional<std::vector<SliceName>> decimal = with_decimals(names))
            if (const std::optional<size_t> number = counting_number(*decimal)) {
                names = std::move(*decimal);
                return *number;
            }
        const auto is_same = [](const SliceName& a, const SliceName& b) { return a.numbers == b.numbers; };
        const auto twice = std::adjacent_find(names.begin(), names.end(), is_same);
        if (twice != names.end()) {
            fail(folder.string(), ": ", in_quotes(twice->file), " and ", in_quotes((twice + 1)->file),
                 " have the same number; expected one file for each slice: remove one of them");
        }
    }
    const bool no_numbers =
        std::all_of(names.begin(), names.end(), [](const SliceName& name) { return name.numbers.empty(); });
    if (no_numbers) {
        fail(folder.string(), ": holds ", names.size(), " ", kind, " without numbers in their names, ",
             in_quotes(names.front().file), " and ", in_quotes(names[1].file),
             " among them; expected the numbered slices of one volume: number them, or open one of the files");
    }
    // Tells series apart by pattern or, within one pattern, by the numbers before the last one that differs.
    size_t last_number = 0;
    for (size_t i = 0; is_one_pattern && i < names.front().numbers.size(); ++i) {
        const auto is_other = [&](const SliceName& name) { return name.numbers[i] != names.front().numbers[i]; };
        if (std::any_of(names.begin(), names.end(), is_other)) last_number = i;
    }
    std::vector<const SliceName*> firsts;
    std::set<std::string> series;
    for (const SliceName& name : names) {
        if (series.insert(is_one_pattern ? series_of(name, last_number) : name.pattern).second) firsts.push_back(&name);
    }
    fail(folder.string(), ": holds ", firsts.size(), " series of slices, from ", in_quotes(firsts[0]->file),
         " on and from ", in_quotes(firsts[1]->file), " on", firsts.size() > 2 ? " among them" : "",
         "; expected one: put each into a folder of its own");
}

void warn_of_gaps(const std::vector<SliceName>& names, size_t number, std::vector<std::string>& warnings)
{
    std::optional<double> step;
    for (size_t i = 1; i < names.size(); ++i) {
        const std::string& a = names[i - 1].numbers[number];
        const std::string& b = names[i].numbers[number];
        const std::optional<double> lower = number_of(a.empty() ? "0" : a), upper = number_of(b);
        constexpr double MOST = 9e15;  // doubles represent all whole numbers up to this limit
        if (!lower || !upper || *upper > MOST) return;
        const double found = *upper - *lower;
        if (!step) step = found;
        if (std::abs(found - *step) <= 1e-6 * *step) continue;
        warnings.push_back(sentence("the numbers of ", in_quotes(names[i - 1].file), " and ", in_quotes(names[i].file),
                                    " are ", found, " apart, those before ", *step,
                                    "; slices may be missing; they were taken as evenly spaced"));
        return;
    }
}

constexpr std::string_view TIFF_EXTENSIONS[] = {".tif", ".tiff"};
constexpr std::string_view PNG_EXTENSIONS[] = {".png"};
constexpr std::string_view BMP_EXTENSIONS[] = {".bmp"};
constexpr std::string_view JPEG_EXTENSIONS[] = {".jpg", ".jpeg"};

bool has_extension(const fs::path& path, std::span<const std::string_view> extensions)
{
    // Skips names that begin with a dot ("._slice1.tif"), under which some systems store metadata.
    return std::ranges::find(extensions, lower_case(path.extension().string())) != extensions.end() &&
           !path.filename().string().starts_with('.');
}

/// Calls `visit` for each entry; fails if the folder cannot be read.
template <class Visit>
void for_each_entry(const fs::path& folder, const Visit& visit)
{
    std::error_code error;
    for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
         entry.increment(error))
        visit(*entry);
    if (error) fail(folder.string(), ": cannot be read: ", error.message());
}

}  // namespace

std::vector<SliceName> slice_names_in(const fs::path& folder, std::span<const std::string_view> extensions,
                                      const char* kind)
{
    std::vector<SliceName> names;
    for_each_entry(folder, [&](const fs::directory_entry& entry) {
        std::error_code unreadable;
        if (!has_extension(entry.path(), extensions) || !entry.is_regular_file(unreadable)) return;
        names.push_back(taken_apart(entry.path()));
        if (names.size() > MAX_SLICES)
            fail(folder.string(), ": holds more than ", MAX_SLICES, " ", kind, "; expected at most that many slices");
    });
    std::sort(names.begin(), names.end(), comes_before);
    return names;
}

void order_slices(const fs::path& folder, const char* kind, const DiffersInSize& differs, std::vector<SliceName>& names,
                  std::vector<std::string>& warnings)
{
    remove_odd_pictures(differs, names, warnings);
    const size_t number = check_one_series(folder, kind, names);
    warn_of_gaps(names, number, warnings);
}

std::span<const std::string_view> extensions_of(SliceFormat format)
{
    switch (format) {
        case SliceFormat::tiff: return TIFF_EXTENSIONS;
        case SliceFormat::png: return PNG_EXTENSIONS;
        case SliceFormat::bmp: return BMP_EXTENSIONS;
        case SliceFormat::jpeg: return JPEG_EXTENSIONS;
    }
    return {};
}

std::optional<SliceFormat> main_slice_format(const fs::path& folder)
{
    std::array<int64_t, std::size(SLICE_FORMATS)> counts{};
    for_each_entry(folder, [&](const fs::directory_entry& entry) {
        for (size_t i = 0; i < counts.size(); ++i)
            counts[i] += has_extension(entry.path(), extensions_of(SLICE_FORMATS[i]));
    });
    const auto most = std::ranges::max_element(counts);
    if (*most == 0) return std::nullopt;
    return SLICE_FORMATS[size_t(most - counts.begin())];
}

}  // namespace shvr
