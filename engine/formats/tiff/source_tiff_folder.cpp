// Opens a folder of TIFFs, one slice each, sorted by the numbers in their names (engine/formats/slices). Ignores files
// of other formats.

#include <tiffio.h>

#include <map>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/slices/skyscan_log.h"
#include "engine/formats/slices/slice_names.h"
#include "engine/formats/tiff/source_tiff.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

constexpr const char* KIND = "TIFFs";

class FolderOpener {
public:
    FolderOpener(const fs::path& folder, const OpenOptions& options, std::vector<SliceName> names)
        : folder_(folder), options_(options), names_(std::move(names))
    {}

    std::unique_ptr<VolumeSource> open()
    {
        const auto differs = [&](const std::string& a, const std::string& b) { return size_of(a) != size_of(b); };
        order_slices(folder_, KIND, differs, names_, volume_.info.warnings);
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
        apply_skyscan_log(volume_.files.front(), volume_.info);
        static_cast<void>(voxel_count(volume_.info));
        return make_tiff_source(std::move(volume_), nullptr);
    }

private:
    std::pair<int64_t, int64_t> size_of(const std::string& name) const
    {
        const TiffFile file(folder_ / name);
        const TiffLayout layout = layout_of(TiffPage(file, read_directories(file).pages.front().offset, 1));
        return {layout.width, layout.height};
    }

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
        // Thousands of files mostly have equal directories, so libtiff reads only one directory of each kind.
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
            // Limits the memory that a maliciously made folder can fill.
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
    std::vector<SliceName> names_;
    std::map<std::string, TiffLayout> layouts_;  ///< by TiffKind::fields
    TiffVolume volume_;
    bool has_warned_ = false;  ///< about errors in a file
};

}  // namespace

std::unique_ptr<VolumeSource> open_tiff_folder(const fs::path& path, const OpenOptions& options)
{
    std::vector<SliceName> names = slice_names_in(path, extensions_of(SliceFormat::tiff), KIND);
    if (names.empty()) return nullptr;
    // TIFFs in a folder with more slices of another format are previews, except a single TIFF with several pages.
    const auto has_one_page = [&] {
        return pages_to_show(read_directories(TiffFile(path / names.front().file))).size() == 1;
    };
    if (main_slice_format(path) != SliceFormat::tiff && (names.size() > 1 || has_one_page())) return nullptr;
    if (names.size() == 1) return open_tiff_file(path / names.front().file, options);
    return FolderOpener(path, options, std::move(names)).open();
}

}  // namespace shvr
