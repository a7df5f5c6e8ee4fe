// Opens TIFF: a file of one or many pages, in any layout that libtiff decodes, with the conventions of ImageJ and
// OME-TIFF. source_tiff_folder.cpp opens folders of such files, one slice each.
//
// x runs to the right, y down, z in page order: right-handed, like the voxels of all formats here. Pages with a
// mirrored Orientation are mirrored back.

#include "engine/formats/tiff/source_tiff.h"

#include <tiffio.h>

#include <algorithm>
#include <map>

#include "engine/base/error.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/readers.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

class TiffSource final : public VolumeSource {
public:
    TiffSource(TiffVolume volume, std::unique_ptr<const TiffFile> file)
        : VolumeSource(std::move(volume.info)),
          layout_(std::move(volume.layout)),
          recipe_(volume.recipe),
          files_(std::move(volume.files)),
          slices_(std::move(volume.slices)),
          file_(std::move(file))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const Size3 size = info().size;
        const Size3 extent = box.size();
        const auto slice_bytes = size_t(extent.x * extent.y) * bytes_of(info().type);
        SHVR_CHECK(glm::all(glm::greaterThanEqual(box.lower, Size3(0))) &&
                   glm::all(glm::lessThanEqual(box.upper, size)) && glm::all(glm::greaterThan(extent, Size3(0))));
        SHVR_CHECK(voxels.size() == slice_bytes * size_t(extent.z), voxels.size());

        TiffRectangle rectangle{box.lower.x, box.lower.y, box.upper.x, box.upper.y};
        if (recipe_.mirrors_x) {
            rectangle.left = size.x - box.upper.x;
            rectangle.right = size.x - box.lower.x;
        }
        if (recipe_.mirrors_y) {
            rectangle.top = size.y - box.upper.y;
            rectangle.bottom = size.y - box.lower.y;
        }
        for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
            const std::span<std::byte> slice_voxels = voxels.first(slice_bytes);
            voxels = voxels.subspan(slice_bytes);
            const TiffSlice& slice = slices_[size_t(z)];
            if (slice.page == 0)
                fail(files_.front().string(), ": lacks the page of slice ", z + 1,
                     ", which its OME-XML names; expected a complete file: it is truncated, or was aborted");
            if (file_) {
                read_rectangle(*file_, slice, layout_, recipe_, rectangle, cache_, slice_voxels);
            } else {
                read_rectangle(TiffFile(files_[slice.file]), slice, layout_, recipe_, rectangle, cache_, slice_voxels);
            }
            mirror(recipe_, extent.x, slice_voxels);
        }
    }

private:
    TiffLayout layout_;
    TiffRecipe recipe_;
    std::vector<fs::path> files_;
    std::vector<TiffSlice> slices_;
    std::unique_ptr<const TiffFile> file_;
    mutable TiffBlockCache cache_;
};

/// Refuses stacks of programs that store all slices in one page and mark the page by a private tag: read like any other
/// page, it would become one slice instead of many.
void refuse_other_stacks(const TiffFile& file, uint64_t directory)
{
    constexpr std::pair<uint16_t, const char*> TAGS[] = {{33629, "MetaMorph (UIC2)"}, {33630, "MetaMorph (UIC3)"}};
    for (const auto& [tag, program] : TAGS) {
        if (!has_field(file, directory, tag)) continue;
        fail(file.path().string(), ": is a stack of ", program,
             "; expected a TIFF with a page for each slice: save it as TIFF, for example from Fiji");
    }
}

class FileOpener {
public:
    FileOpener(const fs::path& path, const OpenOptions& options)
        : options_(options), file_(std::make_unique<const TiffFile>(path)), name_(path.string())
    {}

    std::unique_ptr<VolumeSource> open()
    {
        directories_ = read_directories(*file_);
        volume_.info.warnings = directories_.warnings;
        layouts_.resize(directories_.kinds.size());
        const TiffPage first_page(*file_, directories_.pages.front().offset, 1);
        refuse_other_stacks(*file_, directories_.pages.front().offset);

        // OME-XML states which pages hold slices; otherwise, the run of equal pages with the most voxels is taken.
        const uint32_t first = pages_to_show(directories_).front();
        description_ = read_description(*file_, first_page.text(TIFFTAG_IMAGEDESCRIPTION),
                                        layout_of_page(first).samples, TiffRole::whole);
        take_many_channels_as_slices();
        take_frames_as_slices();
        if (!description_.files.empty()) {
            check_planes_in_files();
        } else if (description_.writer == TiffDescription::Writer::ome) {
            check_planes();
        } else {
            shown_ = main_series(pages_to_show(directories_));
            order_planes();
        }

        const uint32_t shown = shown_.front();
        const TiffPage page(*file_, directories_.pages[shown].offset, shown + 1);
        volume_.layout = layout_of_page(shown);
        check_kinds();

        const std::vector<TiffPixelChannel> of_pixel =
            channels_of_pixel(page, volume_.layout, description_, volume_.info.warnings);
        const OpenOptions wanted =
            description_.channels == 1 ? with_usual_channel(options_, of_pixel, volume_.info.warnings) : options_;
        const TiffChoice choice =
            choose(name_, wanted, names_of_channels(of_pixel), description_.frames,
                   description_.slices == 1 && (description_.channels > 1 || description_.frames > 1));
        const size_t colors = of_pixel.size();
        take_slices(int64_t(choice.channel / colors), choice.frame);
        volume_.info.name = file_->path().filename().string();
        volume_.info.format = "tiff";
        volume_.info.size = {volume_.layout.width, volume_.layout.height, description_.slices};
        apply_recipe(volume_, page, of_pixel[choice.channel % colors], description_);
        apply_tiff_spacing(volume_.info, description_, *file_, directories_.pages.front().offset, first_page);
        static_cast<void>(voxel_count(volume_.info));
        if (!description_.files.empty()) {
            volume_.files = std::move(description_.files);
            return make_tiff_source(std::move(volume_), nullptr);
        }
        volume_.files = {file_->path()};
        return make_tiff_source(std::move(volume_), std::move(file_));
    }

private:
    const TiffLayout& layout_of_kind(uint32_t kind)
    {
        std::optional<TiffLayout>& layout = layouts_[kind];
        if (!layout) {
            const size_t first = directories_.kinds[kind].first_page;
            layout = layout_of(TiffPage(*file_, directories_.pages[first].offset, first + 1));
        }
        return *layout;
    }
    const TiffLayout& layout_of_page(uint32_t page) { return layout_of_kind(directories_.pages[page].kind); }

    /// Takes channels as slices if there are more than the 7 that ImageJ can compose: some scripts confuse the two.
    void take_many_channels_as_slices()
    {
        if (description_.writer != TiffDescription::Writer::imagej || description_.channels <= 7 ||
            description_.slices > 1 || description_.frames > 1 || !options_.channel.empty())
            return;
        volume_.info.warnings.push_back(sentence("the description counts ", description_.channels,
                                                 " channels of one slice each; they were taken as slices"));
        std::swap(description_.channels, description_.slices);
    }

    /// Converts time points or channels of one slice each to slices. Converts time points if the choice is "slices" or,
    /// if nothing was chosen, if there is only one channel. Converts channels only if the choice is "slices".
    void take_frames_as_slices()
    {
        TiffDescription& description = description_;
        if (description.slices > 1) return;
        const bool is_asked = options_.frame == AS_SLICES;
        if (description.frames > 1 && (is_asked || (options_.frame.empty() && description.channels == 1))) {
            if (!is_asked)
                volume_.info.warnings.push_back(sentence("the description counts ", description.frames,
                                                         " time points of one slice each; they were taken as slices; "
                                                         "--frame 1 to ",
                                                         description.frames, " takes one of them"));
            put_frames_first(description.pages);
            put_frames_first(description.file_of_page);
            std::swap(description.frames, description.slices);
            options_.frame.clear();
        } else if (description.channels > 1 && description.frames == 1 && options_.channel == AS_SLICES) {
            std::swap(description.channels, description.slices);
            description.channel_names.clear();
            options_.channel.clear();
        }
    }

    /// Reorders pages so that time points, which are to become slices, vary fastest, and channels second.
    void put_frames_first(std::vector<uint32_t>& of_pages) const
    {
        const std::vector<uint32_t> before = of_pages;
        const auto channels = size_t(description_.channels), frames = size_t(description_.frames);
        for (size_t i = 0; i < before.size(); ++i) of_pages[i / channels + frames * (i % channels)] = before[i];
    }

    /// Checks the first page of each kind, and that the file can hold all pages of that kind.
    void check_kinds()
    {
        std::vector<int64_t> pages(directories_.kinds.size());
        for (const uint32_t page : shown_) {
            const uint32_t kind = directories_.pages[page].kind;
            if (pages[kind]++ > 0) continue;
            const TiffPage first(*file_, directories_.pages[page].offset, page + 1);
            check_is_supported(first, layout_of_kind(kind));
            check_blocks(*file_, first, layout_of_kind(kind));
        }
        for (size_t kind = 0; kind < pages.size(); ++kind) {
            if (pages[kind] > 0) check_amount(*file_, *layouts_[kind], pages[kind]);
        }
    }

    /// Returns the run of equal pages with the most voxels. The pages before and after the run are left out.
    std::vector<uint32_t> main_series(const std::vector<uint32_t>& pages)
    {
        if (pages.size() < directories_.pages.size()) {
            volume_.info.warnings.push_back(sentence(directories_.pages.size() - pages.size(),
                                                     " pages are smaller copies or masks and were left out"));
        }
        std::vector<std::pair<size_t, size_t>> runs;  // [begin, end) in `pages`
        for (size_t i = 0; i < pages.size(); ++i) {
            if (i == 0 || !is_like(pages[i], pages[i - 1])) runs.emplace_back(i, i);
            runs.back().second = i + 1;
        }
        const auto voxels = [&](const std::pair<size_t, size_t>& run) {
            const TiffLayout& layout = layout_of_page(pages[run.first]);
            return double(layout.width * layout.height) * double(run.second - run.first);
        };
        const auto main = *std::max_element(runs.begin(), runs.end(),
                                            [&](const auto& a, const auto& b) { return voxels(a) < voxels(b); });
        for (const auto& run : runs) {
            if (run == main) continue;
            const uint32_t other = pages[run.first];
            if (is_like(other, pages[main.first])) {
                const uint32_t odd = pages[main.first < run.first ? main.second : run.second];
                fail(name_, ": page ", odd + 1, " has ", in_words(layout_of_page(odd)), "; expected ",
                     in_words(layout_of_page(other)), ", as the pages before and after it");
            }
            volume_.info.warnings.push_back(
                sentence(run.second - run.first, run.second - run.first == 1 ? " page of " : " pages of ",
                         in_words(layout_of_page(other)), " from page ", other + 1, " on ",
                         run.second - run.first == 1 ? "was" : "were", " left out: the volume is the ",
                         main.second - main.first, main.second - main.first == 1 ? " page of " : " pages of ",
                         in_words(layout_of_page(pages[main.first]))));
        }
        return {pages.begin() + std::ptrdiff_t(main.first), pages.begin() + std::ptrdiff_t(main.second)};
    }

    bool is_like(uint32_t a, uint32_t b)
    {
        return directories_.pages[a].kind == directories_.pages[b].kind ||
               show_the_same(layout_of_page(a), layout_of_page(b));
    }

    /// Checks the number of pages against ImageJ's description. Empty `pages` stand for ImageJ's order.
    void order_planes()
    {
        const int64_t planes = description_.slices * description_.channels * description_.frames;
        const auto found = int64_t(shown_.size());
        if (planes > found && found == 1 && directories_.pages.size() == 1) {
            check_contiguous(planes);
        } else if (planes != found) {
            if (description_.channels > 1 || description_.frames > 1) {
                fail(name_, ": its ImageJ description counts ", description_.channels, " channels of ",
                     description_.slices, " slices at ", description_.frames, " time points; expected ", planes,
                     " pages, but it holds ", found);
            }
            if (planes > 1) {
                volume_.info.warnings.push_back(sentence("the description counts ", planes, " images, the file holds ",
                                                         found, " pages; all pages were taken"));
            }
            description_.slices = found;
        }
        description_.pages.clear();
    }

    /// Checks ImageJ's layout for stacks above 4 GiB, which smaller stacks may also use: the file has only one
    /// directory, and the voxels of all images follow each other without gaps.
    void check_contiguous(int64_t planes)
    {
        const TiffPage page(*file_, directories_.pages.front().offset, 1);
        const TiffLayout& layout = layout_of_page(0);
        const auto refuse = [&](const auto&... found) {
            fail(name_, ": its ImageJ description counts ", planes, " images, but it holds one page ", found...);
        };
        if (!layout.is_bare() || layout.is_tiled || layout.is_planar) {
            refuse("that is ", layout.is_bare() ? "in tiles or planes" : "compressed",
                   "; expected a page for each image");
        }
        check_is_supported(page, layout);
        const TiffExtent first = extent_of_block(*file_, page, layout, 0);
        for (int64_t block = 1; block < layout.blocks(); ++block) {
            const TiffExtent extent = extent_of_block(*file_, page, layout, block);
            if (extent.offset == first.offset + block * layout.block_height * layout.block_row_bytes()) continue;
            refuse("whose strips have gaps; expected strips that follow each other, or a page for each image");
        }
        // page_bytes() cannot overflow: a page has at most 2^40 pixels, and the file holds all of its samples.
        int64_t needed = 0;
        if (__builtin_mul_overflow(planes, layout.page_bytes(), &needed) ||
            !file_->holds(uint64_t(first.offset), uint64_t(needed))) {
            refuse("and ", file_->size_bytes() - first.offset, " bytes of voxels; expected ", needed,
                   ": it is truncated, or pages are missing");
        }
        is_contiguous_ = true;
    }

    /// Checks that the pages that OME-XML names are alike. If a program was stopped while writing, the last pages are
    /// missing: their slices cannot be read, but all others can.
    void check_planes()
    {
        uint32_t lacking = 0;
        for (uint32_t& plane : description_.pages) {
            if (plane == TiffDescription::NO_PAGE) continue;
            if (plane >= directories_.pages.size()) {
                ++lacking;
                plane = LACKING_PAGE;
                continue;
            }
            if (shown_.empty() || is_like(plane, shown_.front())) {
                shown_.push_back(plane);
                plane = uint32_t(shown_.size() - 1);
                continue;
            }
            fail(name_, ": page ", plane + 1, " has ", in_words(layout_of_page(plane)), "; expected ",
                 in_words(layout_of_page(shown_.front())), ", as the others of its image");
        }
        if (shown_.empty()) fail(name_, ": its OME-XML names no page of the file; expected one for each slice");
        if (lacking / MAX_LACKING > shown_.size())
            fail(name_, ": its OME-XML names ", lacking, " pages more than the ", directories_.pages.size(),
                 " that the file holds; expected at most ", MAX_LACKING, " missing ones for each that is there");
        if (lacking > 0)
            volume_.info.warnings.push_back(sentence("its OME-XML names ", lacking, " pages more than the ",
                                                     directories_.pages.size(),
                                                     " that the file holds: it is truncated, or its writing was "
                                                     "aborted; their slices cannot be read"));
    }

    /// Does the same as check_planes(), for a stack in several files.
    void check_planes_in_files()
    {
        std::map<std::pair<uint32_t, uint32_t>, TiffLayout> layouts;  // by file and kind
        std::vector<std::optional<TiffDirectories>> directories(description_.files.size());
        std::optional<TiffLayout> first;
        slices_in_files_.resize(description_.pages.size());
        for (size_t i = 0; i < description_.pages.size(); ++i) {
            const uint32_t number = description_.file_of_page[i], plane = description_.pages[i];
            if (plane == TiffDescription::NO_PAGE) continue;
            const TiffFile file(description_.files[number]);
            std::optional<TiffDirectories>& of_file = directories[number];
            if (!of_file) of_file = read_directories(file);
            if (plane >= of_file->pages.size())
                fail(file.path().string(), ": holds ", of_file->pages.size(), " pages; expected page ", plane + 1,
                     ", which the OME-XML of ", name_, " names");
            const TiffDirectory& directory = of_file->pages[plane];
            const auto [known, is_new] = layouts.try_emplace({number, directory.kind});
            if (is_new) {
                const TiffPage page(file, directory.offset, plane + 1);
                known->second = layout_of(page);
                if (!first) first = known->second;
                if (!show_the_same(known->second, *first))
                    fail(file.path().string(), ": has ", in_words(known->second), "; expected ", in_words(*first),
                         ", as the first page of ", name_);
                check_is_supported(page, known->second);
                check_blocks(file, page, known->second);
            }
            slices_in_files_[i] = {number, plane + 1, directory.offset, 0};
            if (number == 0) shown_.push_back(plane);
        }
        if (shown_.empty()) fail(name_, ": its OME-XML names no page of this file; expected some");
    }

    std::vector<std::string> names_of_channels(const std::vector<TiffPixelChannel>& of_pixel) const
    {
        std::vector<std::string> names;
        for (int64_t channel = 0; channel < description_.channels; ++channel) {
            for (const TiffPixelChannel& part : of_pixel) {
                const auto index = size_t(channel);
                const bool has_name = index < description_.channel_names.size();
                if (of_pixel.size() == 1) {
                    names.push_back(has_name ? description_.channel_names[index] : std::string());
                } else {
                    names.push_back(description_.channels == 1 ? part.name : std::string());
                }
            }
        }
        return names;
    }

    void take_slices(int64_t channel, int64_t frame)
    {
        for (int64_t z = 0; z < description_.slices; ++z) {
            const int64_t in_order = channel + description_.channels * (z + description_.slices * frame);
            if (is_contiguous_) {
                volume_.slices.push_back({0, 1, directories_.pages[0].offset, in_order * volume_.layout.page_bytes()});
                continue;
            }
            auto place = size_t(in_order);
            if (!description_.pages.empty()) {
                const int64_t at = z + description_.slices * (channel + description_.channels * frame);
                const uint32_t stated = description_.pages[size_t(at)];
                if (stated == TiffDescription::NO_PAGE) {
                    fail(name_, ": its OME-XML names no page for slice ", z + 1, "; expected one for each slice");
                }
                if (stated == LACKING_PAGE || !slices_in_files_.empty()) {
                    volume_.slices.push_back(stated == LACKING_PAGE ? TiffSlice{.page = 0}
                                                                    : slices_in_files_[size_t(at)]);
                    continue;
                }
                place = stated;
            }
            const uint32_t page = shown_[place];
            volume_.slices.push_back({0, page + 1, directories_.pages[page].offset, 0});
        }
        // A truncated file lacks its end.
        const TiffSlice& last = volume_.slices.back();
        if (last.page == 0 || !slices_in_files_.empty()) return;
        const TiffPage page(*file_, last.directory, last.page);
        check_blocks(*file_, page, layout_of(page));
    }

    static constexpr uint32_t LACKING_PAGE = TiffDescription::NO_PAGE - 1;
    static constexpr uint32_t MAX_LACKING = 64;  ///< missing pages per existing page; bounds memory by the file's size

    OpenOptions options_;
    std::unique_ptr<const TiffFile> file_;
    std::string name_;
    TiffDirectories directories_;
    std::vector<std::optional<TiffLayout>> layouts_;  ///< by kind; filled on first use
    TiffDescription description_;
    std::vector<uint32_t> shown_;             ///< pages
    std::vector<TiffSlice> slices_in_files_;  ///< by index into the description's `pages`
    bool is_contiguous_ = false;
    TiffVolume volume_;
};

}  // namespace

std::vector<uint32_t> pages_to_show(const TiffDirectories& directories)
{
    std::vector<uint32_t> all, whole;
    for (size_t i = 0; i < directories.pages.size(); ++i) {
        all.push_back(uint32_t(i));
        if (!directories.kinds[directories.pages[i].kind].is_reduced) whole.push_back(all.back());
    }
    return whole.empty() ? all : whole;
}

void apply_recipe(TiffVolume& volume, const TiffPage& page, const TiffPixelChannel& channel,
                  const TiffDescription& description)
{
    const TiffLayout& layout = volume.layout;
    TiffRecipe& recipe = volume.recipe;
    std::vector<std::string>& warnings = volume.info.warnings;
    recipe.sample = channel.sample;
    recipe.palette_color = channel.palette_color;
    recipe.type = *voxel_type_of(layout);
    if (channel.palette_color >= 0) {
        recipe.palette_has_8_bits = has_8_bits(palette_of(page, layout, channel.palette_color));
        recipe.type = recipe.palette_has_8_bits ? VoxelType::uint8 : VoxelType::uint16;
    }
    if (layout.photometric == PHOTOMETRIC_MINISWHITE) {
        if (layout.sample_format == SAMPLEFORMAT_IEEEFP) {
            warnings.emplace_back("its smallest values are meant to be white; they are shown as stored");
        } else {
            recipe.exchanged_bits = layout.sample_format == SAMPLEFORMAT_INT || layout.bits == 64
                                        ? ~uint64_t{0}
                                        : (uint64_t{1} << layout.bits) - 1;
            warnings.emplace_back("in the file 0 is white (MinIsWhite); intensities were inverted");
        }
    }
    if (description.counts_from_minus_32768 && recipe.type == VoxelType::uint16 && layout.bits == 16) {
        recipe.type = VoxelType::int16;
        recipe.exchanged_bits ^= 0x8000;
    }
    recipe.mirrors_x = layout.orientation == ORIENTATION_TOPRIGHT || layout.orientation == ORIENTATION_BOTRIGHT;
    recipe.mirrors_y = layout.orientation == ORIENTATION_BOTLEFT || layout.orientation == ORIENTATION_BOTRIGHT;
    if (recipe.mirrors_x || recipe.mirrors_y) {
        warnings.push_back(sentence("Orientation is ", layout.orientation, ": ",
                                    recipe.mirrors_x ? "columns are stored from right to left" : "",
                                    recipe.mirrors_x && recipe.mirrors_y ? " and " : "",
                                    recipe.mirrors_y ? "rows are stored from bottom to top" : "",
                                    "; they were reordered"));
    }
    volume.info.type = recipe.type;
}

std::unique_ptr<VolumeSource> make_tiff_source(TiffVolume volume, std::unique_ptr<const TiffFile> file)
{
    const StoredNumber number = stored_number_of(volume.layout);
    const std::string name = volume.files.front().string();
    return widened(std::make_unique<TiffSource>(std::move(volume), std::move(file)), number, name);
}

std::unique_ptr<VolumeSource> open_tiff_file(const fs::path& path, const OpenOptions& options)
{
    return FileOpener(path, options).open();
}

std::unique_ptr<VolumeSource> open_tiff(const fs::path& path, const OpenOptions& options)
{
    std::error_code error;
    if (fs::is_directory(path, error)) return open_tiff_folder(path, options);
    const std::string extension = lower_case(path.extension().string());
    if (!TiffFile::begins(read_head(path, 16)) && extension != ".tif" && extension != ".tiff") return nullptr;
    return open_tiff_file(path, options);
}

}  // namespace shvr
