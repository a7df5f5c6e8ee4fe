// A folder of TIFFs, one slice each, in the order of the numbers in their names. Other kinds of files are ignored. Two
// series in one folder are refused rather than separated by guessing.

#include <tiffio.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/tiff/source_tiff.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

/// A file's name without its extension, split up: "Slice_007b" is "slice_/b" and 7. No name holds a slash.
struct SliceName {
    std::string file;
    std::string pattern;
    std::vector<std::string> numbers;  ///< digits without leading zeros
};

SliceName taken_apart(const fs::path& path)
{
    SliceName name{path.filename().string()};
    const std::string stem = lower_case(path.stem().string());
    for (size_t at = 0; at < stem.size();) {
        if (!is_digit(stem[at])) {
            name.pattern += stem[at++];
            continue;
        }
        const size_t begin = std::min(stem.find_first_not_of('0', at), stem.size());
        while (at < stem.size() && is_digit(stem[at])) ++at;
        name.pattern += '/';
        name.numbers.push_back(stem.substr(std::min(begin, at), at - std::min(begin, at)));
    }
    return name;
}

/// Compares as numbers, however long.
bool is_less(const std::string& a, const std::string& b)
{
    return a.size() != b.size() ? a.size() < b.size() : a < b;
}

bool comes_before(const SliceName& a, const SliceName& b)
{
    if (a.pattern != b.pattern) return a.pattern < b.pattern;
    for (size_t i = 0; i < a.numbers.size(); ++i) {
        if (a.numbers[i] != b.numbers[i]) return is_less(a.numbers[i], b.numbers[i]);
    }
    return a.file < b.file;
}

std::vector<SliceName> names_in(const fs::path& folder)
{
    std::vector<SliceName> names;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
        const fs::path& path = entry->path();
        const std::string extension = lower_case(path.extension().string());
        std::error_code unreadable;
        // Other systems keep metadata in files whose names begin with a dot ("._slice1.tif").
        if ((extension != ".tif" && extension != ".tiff") || path.filename().string().starts_with('.')) continue;
        if (!entry->is_regular_file(unreadable)) continue;
        names.push_back(taken_apart(path));
        if (names.size() > MAX_TIFF_PAGES) {
            fail(folder.string(), ": holds more than ", MAX_TIFF_PAGES, " TIFFs; expected at most that many slices");
        }
    }
    if (error) fail(folder.string(), ": cannot be read: ", error.message());
    std::sort(names.begin(), names.end(), comes_before);
    return names;
}

/// The number that counts the slices: the first one that differs from file to file and never decreases. Null if the
/// names belong to several series.
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

/// The name of the series: everything before the last number that differs.
std::string series_of(const SliceName& name, size_t last_number)
{
    std::string series = name.pattern;
    for (size_t i = 0; i < last_number; ++i) series += "," + name.numbers[i];
    return series;
}

/// Fails if the names belong to several series.
size_t check_one_series(const fs::path& folder, const std::vector<SliceName>& names)
{
    const bool is_one_pattern = names.front().pattern == names.back().pattern;
    if (is_one_pattern && names.front().numbers.empty()) {
        fail(folder.string(), ": ", in_quotes(names.front().file), " and ", in_quotes(names.back().file),
             " differ only in their extension; expected one of them: remove the other");
    }
    if (is_one_pattern) {
        if (const std::optional<size_t> number = counting_number(names)) return *number;
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
        fail(folder.string(), ": holds ", names.size(), " TIFFs without numbers in their names, ",
             in_quotes(names.front().file), " and ", in_quotes(names[1].file),
             " among them; expected the numbered slices of one volume: number them, or open one of the files");
    }
    // Sorted by pattern; within one, by the numbers before the last one that differs.
    size_t last_number = 0;
    for (size_t i = 0; is_one_pattern && i < names.front().numbers.size(); ++i) {
        const auto differs = [&](const SliceName& name) { return name.numbers[i] != names.front().numbers[i]; };
        if (std::any_of(names.begin(), names.end(), differs)) last_number = i;
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

/// Warns about gaps in the numbering, since slices are drawn evenly spaced.
void warn_of_gaps(const std::vector<SliceName>& names, size_t number, std::vector<std::string>& warnings)
{
    std::optional<int64_t> step;
    for (size_t i = 1; i < names.size(); ++i) {
        const std::string& a = names[i - 1].numbers[number];
        const std::string& b = names[i].numbers[number];
        const std::optional<int64_t> lower = whole_of(a.empty() ? "0" : a);
        const std::optional<int64_t> upper = whole_of(b);
        if (!lower || !upper) return;
        const int64_t found = *upper - *lower;
        if (!step) step = found;
        if (found == *step) continue;
        warnings.push_back(sentence("the numbers of ", in_quotes(names[i - 1].file), " and ", in_quotes(names[i].file),
                                    " are ", found, " apart, those before ", *step,
                                    "; slices may be missing; they were taken as evenly spaced"));
        return;
    }
}

class FolderOpener {
public:
    FolderOpener(const fs::path& folder, const OpenOptions& options, const std::vector<SliceName>& names)
        : folder_(folder), options_(options), names_(names)
    {}

    std::unique_ptr<VolumeSource> open()
    {
        warn_of_gaps(names_, check_one_series(folder_, names_), volume_.info.warnings);
        for (size_t i = 0; i < names_.size(); ++i) add_file(i);

        const TiffFile file(volume_.files.front());
        const TiffSlice& slice = volume_.slices.front();
        const TiffPage page(file, slice.directory, slice.page);
        const TiffDescription description = description_of(file, page);
        const std::vector<TiffPixelChannel> channels =
            channels_of_pixel(page, volume_.layout, description, volume_.info.warnings);
        std::vector<std::string> channel_names;
        for (const TiffPixelChannel& channel : channels) channel_names.push_back(channel.name);
        const OpenOptions wanted = with_usual_channel(options_, channels, volume_.info.warnings);
        const TiffChoice choice = choose(folder_.string(), wanted, channel_names, 1);
        apply_recipe(volume_, page, channels[choice.channel], description);

        const fs::path whole = fs::absolute(folder_).lexically_normal();
        volume_.info.name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
        volume_.info.format = "tiff";
        volume_.info.size = {volume_.layout.width, volume_.layout.height, int64_t(volume_.slices.size())};
        apply_tiff_spacing(volume_.info, description, file, slice.directory, page);
        static_cast<void>(voxel_count(volume_.info));
        return make_tiff_source(std::move(volume_), nullptr);
    }

private:
    void add_file(size_t index)
    {
        volume_.files.push_back(folder_ / names_[index].file);
        const TiffFile file(volume_.files.back());
        const TiffDirectories directories = read_directories(file);
        if (!directories.warnings.empty() && !std::exchange(has_warned_, true))
            volume_.info.warnings.push_back(names_[index].file + ": " + directories.warnings.front());
        const std::vector<uint32_t> shown = pages_to_show(directories);
        if (shown.size() > 1) {
            fail(file.path().string(), ": holds ", shown.size(), " pages; expected one, as a slice of the folder: ",
                 "open the file itself, or put it into a folder of its own");
        }
        const TiffDirectory& directory = directories.pages[shown.front()];
        const size_t number = shown.front() + 1;
        // Directories in thousands of files are mostly alike, so libtiff reads only one of each kind.
        const auto known = layouts_.find(directories.kinds[directory.kind].fields);
        if (known != layouts_.end()) {
            check_amount(file, known->second, 1);
        } else {
            const TiffPage page(file, directory.offset, number);
            const TiffLayout layout = layout_of(page);
            if (index == 0) volume_.layout = layout;
            if (!show_the_same(layout, volume_.layout)) {
                fail(file.path().string(), ": has ", in_words(layout), "; expected ", in_words(volume_.layout), ", as ",
                     names_.front().file);
            }
            check_is_supported(page, layout);
            check_blocks(file, page, layout);
            // Bounds the memory that a hostile folder can fill.
            if (layouts_.size() < 64) layouts_.emplace(directories.kinds[directory.kind].fields, layout);
        }
        volume_.slices.push_back({uint32_t(index), uint32_t(number), directory.offset, 0});
    }

    TiffDescription description_of(const TiffFile& file, const TiffPage& page) const
    {
        const TiffDescription description =
            read_description(file, page.text(TIFFTAG_IMAGEDESCRIPTION), volume_.layout.samples, TiffRole::slice);
        const auto slices = int64_t(volume_.slices.size());
        if (description.channels > 1 || description.frames > 1) {
            fail(folder_.string(), ": the description of its first file states ", description.channels,
                 " channels and ", description.frames,
                 " time points; expected one of each: save one channel of one time point");
        }
        if (description.writer == TiffDescription::Writer::imagej && description.slices > 1 &&
            description.slices != slices) {
            fail(file.path().string(), ": its ImageJ description counts ", description.slices,
                 " images; expected one, or the ", slices, " files of the folder");
        }
        return description;
    }

    const fs::path& folder_;
    const OpenOptions& options_;
    const std::vector<SliceName>& names_;
    std::map<std::string, TiffLayout> layouts_;  ///< by TiffKind::fields
    TiffVolume volume_;
    bool has_warned_ = false;  ///< about errors in a file
};

}  // namespace

std::unique_ptr<VolumeSource> open_tiff_folder(const fs::path& path, const OpenOptions& options)
{
    const std::vector<SliceName> names = names_in(path);
    if (names.empty()) return nullptr;
    if (names.size() == 1) return open_tiff_file(path / names.front().file, options);
    return FolderOpener(path, options, names).open();
}

}  // namespace shvr
