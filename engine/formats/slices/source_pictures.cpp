// Opens a folder of PNG, BMP or JPEG slices, sorted by the numbers in their names, or one such file as a volume of one
// slice. x runs to the right, y down, z from slice to slice.

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <random>

#include "engine/base/error.h"
#include "engine/formats/data_files.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/readers.h"
#include "engine/formats/slices/picture_file.h"
#include "engine/formats/slices/skyscan_log.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

const char* name_of(SliceFormat format)
{
    switch (format) {
        case SliceFormat::tiff: return "TIFF";
        case SliceFormat::png: return "PNG";
        case SliceFormat::bmp: return "BMP";
        case SliceFormat::jpeg: return "JPEG";
    }
    return "";
}

/// Caches decoded slices, because bricks need a part of each slice but pictures can only be decoded from their first
/// row on. Evicts at random: a repeated pass through a volume would need exactly the slices that LRU has evicted.
class SliceCache {
public:
    using Slice = std::shared_ptr<const std::vector<std::byte>>;

    Slice find(int64_t z) const
    {
        const std::lock_guard lock(mutex_);
        const auto found = slices_.find(z);
        return found == slices_.end() ? nullptr : found->second;
    }

    void keep(int64_t z, Slice slice)
    {
        const std::lock_guard lock(mutex_);
        bytes_ += slice->size();
        if (const auto [known, is_new] = slices_.try_emplace(z, slice); !is_new) bytes_ -= slice->size();
        while (bytes_ > MAX_BYTES) {
            const auto victim = std::next(slices_.begin(), std::ptrdiff_t(random_() % slices_.size()));
            bytes_ -= victim->second->size();
            slices_.erase(victim);
        }
    }

    static constexpr size_t MAX_BYTES = size_t{64} << 20;

private:
    mutable std::mutex mutex_;
    std::map<int64_t, Slice> slices_;
    size_t bytes_ = 0;
    std::minstd_rand random_;
};

struct Pictures {
    SliceFormat format = SliceFormat::png;
    std::vector<fs::path> files{};
    PictureLayout layout{};  ///< of every file
    int channel = 0;         ///< among the samples
};

class PictureSource final : public VolumeSource {
public:
    PictureSource(VolumeInfo info, Pictures pictures) : VolumeSource(std::move(info)), pictures_(std::move(pictures)) {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const Size3 size = info().size, extent = box.size();
        const size_t voxel_bytes = bytes_of(info().type), row_bytes = size_t(extent.x) * voxel_bytes;
        SHVR_CHECK(glm::all(glm::greaterThanEqual(box.lower, Size3(0))) &&
                   glm::all(glm::lessThanEqual(box.upper, size)) && glm::all(glm::greaterThan(extent, Size3(0))));
        SHVR_CHECK(voxels.size() == row_bytes * size_t(extent.y * extent.z), voxels.size());
        const size_t slice_bytes = size_t(size.x * size.y) * voxel_bytes;
        const bool is_whole = extent.x == size.x && extent.y == size.y;
        for (int64_t z = box.lower.z; z < box.upper.z; ++z, voxels = voxels.subspan(row_bytes * size_t(extent.y))) {
            if (is_whole || slice_bytes > SliceCache::MAX_BYTES / 4) {
                decode(z, box, voxels);
                continue;
            }
            SliceCache::Slice slice = cache_.find(z);
            if (!slice) {
                auto decoded = std::make_shared<std::vector<std::byte>>(slice_bytes);
                decode(z, {{0, 0, z}, {size.x, size.y, z + 1}}, *decoded);
                cache_.keep(z, slice = std::move(decoded));
            }
            for (int64_t y = 0; y < extent.y; ++y) {
                const size_t from = size_t(box.lower.x + size.x * (box.lower.y + y)) * voxel_bytes;
                std::memcpy(voxels.data() + size_t(y) * row_bytes, slice->data() + from, row_bytes);
            }
        }
    }

private:
    /// Decodes slice z from its first row to the box's last one, and copies the part inside the box into `voxels`.
    void decode(int64_t z, const VoxelBox& box, std::span<std::byte> voxels) const
    {
        const fs::path& path = pictures_.files[size_t(z)];
        const std::unique_ptr<PictureFile> file = open_picture(path, pictures_.format);
        if (file->layout() != pictures_.layout)
            fail(path.string(), ": has ", in_words(file->layout()), "; expected ", in_words(pictures_.layout),
                 ", as when it was opened");
        const size_t voxel_bytes = bytes_of(info().type), pixel_bytes = voxel_bytes * size_t(pictures_.layout.samples);
        const auto columns = size_t(box.size().x);
        file->read(box.lower.y, box.upper.y, [&](int64_t y, std::span<const std::byte> row) {
            std::byte* to = voxels.data() + size_t(y - box.lower.y) * columns * voxel_bytes;
            const std::byte* from =
                row.data() + size_t(box.lower.x) * pixel_bytes + size_t(pictures_.channel) * voxel_bytes;
            for (size_t x = 0; x < columns; ++x, to += voxel_bytes, from += pixel_bytes)
                std::memcpy(to, from, voxel_bytes);
        });
    }

    Pictures pictures_;
    mutable SliceCache cache_;
};

/// Returns the colour channel that the options choose. The alpha channel of grey pictures is dropped.
int channel_of(const std::string& name, const PictureLayout& layout, const OpenOptions& options,
               std::vector<std::string>& warnings)
{
    if (layout.is_sliceable() && options.channel.empty()) {
        if (layout.has_alpha) warnings.emplace_back("its alpha channel was left out");
        return 0;
    }
    static constexpr const char* GREY[] = {"grey", "alpha"};
    const std::span<const char* const> names =
        layout.is_sliceable() ? std::span(GREY).first(size_t(layout.samples)) : color_names(layout.samples);
    return int(chosen_channel(name, options, layout.samples, names));
}

std::unique_ptr<VolumeSource> source_of(const fs::path& path, VolumeInfo info, Pictures pictures,
                                        const OpenOptions& options)
{
    pictures.channel = channel_of(path.string(), pictures.layout, options, info.warnings);
    static_cast<void>(chosen_frame(path.string(), options, 1));
    if (pictures.format == SliceFormat::jpeg)
        info.warnings.emplace_back("JPEG changes intensities; the scan's own slices are more accurate");
    info.format = lower_case(name_of(pictures.format));
    info.size = {pictures.layout.width, pictures.layout.height, int64_t(pictures.files.size())};
    info.type = pictures.layout.type;
    apply_spacing(info, std::nullopt, std::nullopt, "voxel");
    if (pictures.files.size() > 1) apply_skyscan_log(pictures.files.front(), info);
    static_cast<void>(voxel_count(info));
    return std::make_unique<PictureSource>(std::move(info), std::move(pictures));
}

std::unique_ptr<VolumeSource> open_folder(const fs::path& folder, SliceFormat format, const OpenOptions& options)
{
    const std::string kind = sentence(name_of(format), " files");
    std::vector<SliceName> names = slice_names_in(folder, extensions_of(format), kind.c_str());
    const fs::path whole = fs::absolute(folder).lexically_normal();
    VolumeInfo info{.name = (whole.has_filename() ? whole : whole.parent_path()).filename().string()};
    const auto layout_at = [&](const std::string& file) { return open_picture(folder / file, format)->layout(); };
    const auto differs = [&](const std::string& a, const std::string& b) {
        const PictureLayout of_a = layout_at(a), of_b = layout_at(b);
        return of_a.width != of_b.width || of_a.height != of_b.height;
    };
    if (names.size() > 1) order_slices(folder, kind.c_str(), differs, names, info.warnings);
    Pictures pictures{.format = format, .layout = layout_at(names.front().file)};
    for (const SliceName& name : names) {
        pictures.files.push_back(folder / name.file);
        const PictureLayout layout = layout_at(name.file);
        if (layout != pictures.layout)
            fail(pictures.files.back().string(), ": has ", in_words(layout), "; expected ", in_words(pictures.layout),
                 ", as ", names.front().file);
    }
    return source_of(folder, std::move(info), std::move(pictures), options);
}

std::unique_ptr<VolumeSource> open_pictures(const fs::path& path, SliceFormat format, const OpenOptions& options)
{
    std::error_code ignored;
    if (fs::is_directory(path, ignored))
        return main_slice_format(path) == format ? open_folder(path, format, options) : nullptr;
    const bool is_named =
        std::ranges::find(extensions_of(format), lower_case(path.extension().string())) != extensions_of(format).end();
    const std::optional<SliceFormat> found = picture_format(path);
    if (found != format) {
        if (!is_named || found) return nullptr;
        fail(path.string(), ": is no ", name_of(format), " file by its first bytes; expected one, as its name says");
    }
    Pictures pictures{.format = format, .files = {path}, .layout = open_picture(path, format)->layout()};
    return source_of(path, {.name = path.filename().string()}, std::move(pictures), options);
}

}  // namespace

std::unique_ptr<VolumeSource> open_png(const fs::path& path, const OpenOptions& options)
{
    return open_pictures(path, SliceFormat::png, options);
}

std::unique_ptr<VolumeSource> open_bmp(const fs::path& path, const OpenOptions& options)
{
    return open_pictures(path, SliceFormat::bmp, options);
}

std::unique_ptr<VolumeSource> open_jpeg(const fs::path& path, const OpenOptions& options)
{
    return open_pictures(path, SliceFormat::jpeg, options);
}

}  // namespace shvr
