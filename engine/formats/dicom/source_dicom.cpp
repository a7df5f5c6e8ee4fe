// Opens DICOM: a folder of slices, one slice of a series, or a file with many frames. Slices are decoded on demand, and
// a few decoded slices are cached.

#include <algorithm>
#include <mutex>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/dicom/dicom_layout.h"
#include "engine/formats/dicom/dicom_series.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/readers.h"
#include "engine/formats/rescaled.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

constexpr int64_t KEPT_BYTES = int64_t{64} << 20;
constexpr size_t MAX_FILES = 65536;

class DicomSource final : public VolumeSource {
public:
    DicomSource(VolumeInfo info, std::vector<DicomFile> files, std::vector<DicomSlice> slices)
        : VolumeSource(std::move(info)), files_(std::move(files)), slices_(std::move(slices))
    {
        const Size3 size = this->info().size;
        pixels_ = size_t(size.x * size.y);
        max_kept_ = size_t(std::max<int64_t>(2, KEPT_BYTES / (size.x * size.y * int64_t(bytes_of(this->info().type)))));
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const Size3 extent = box.size();
        const size_t voxel_bytes = bytes_of(info().type);
        const size_t row_bytes = size_t(extent.x) * voxel_bytes;
        SHVR_CHECK(voxels.size() == row_bytes * size_t(extent.y * extent.z), voxels.size());
        std::byte* row = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
            const std::shared_ptr<const Pixels> slice = decoded(size_t(z));
            for (int64_t y = box.lower.y; y < box.upper.y; ++y, row += row_bytes) {
                const auto first = size_t(box.lower.x + info().size.x * y) * voxel_bytes;
                std::copy_n(slice->begin() + std::ptrdiff_t(first), row_bytes, row);
            }
        }
    }

private:
    using Pixels = std::vector<std::byte>;
    struct Kept {
        size_t slice = 0;
        std::shared_ptr<const Pixels> pixels{};
    };

    std::shared_ptr<const Pixels> decoded(size_t number) const
    {
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.slice == number; });
        if (found != kept_.end()) {
            std::rotate(kept_.begin(), found, found + 1);  // most recently used first
            return kept_.front().pixels;
        }
        const DicomSlice& slice = slices_[number];
        const DicomFile& file = files_[slice.file];
        Pixels stored = read_dicom_pixels(file, slice.frame, pixels_ * bytes_of(file.type));
        const Rescale& rescale = file.frames[slice.frame].rescale;
        if (!rescale.changes_nothing() || file.type != info().type) {
            Pixels intensities(pixels_ * bytes_of(info().type));
            rescale_voxels(file.type, stored, rescale, info().type, intensities);
            stored = std::move(intensities);
        }
        if (kept_.size() == max_kept_) kept_.pop_back();
        return kept_.insert(kept_.begin(), {number, std::make_shared<const Pixels>(std::move(stored))})->pixels;
    }

    std::vector<DicomFile> files_;
    std::vector<DicomSlice> slices_;
    size_t pixels_ = 0;  ///< per slice
    size_t max_kept_ = 2;
    mutable std::mutex mutex_;
    mutable std::vector<Kept> kept_;
};

bool is_dicom(const fs::path& path)
{
    std::error_code error;
    return fs::is_regular_file(path, error) && begins_as_dicom(open_input_file(path));
}

std::vector<fs::path> dicom_files_in(const fs::path& folder)
{
    std::vector<fs::path> paths;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        if (!at->path().filename().string().starts_with('.') && is_dicom(at->path())) paths.push_back(at->path());
        if (paths.size() > MAX_FILES)
            fail(folder.string(), ": holds more than ", MAX_FILES, " files; expected at most that many");
    }
    if (error) fail(folder.string(), ": cannot be read: ", error.message());
    std::sort(paths.begin(), paths.end());
    return paths;
}

/// Returns the DICOM files in the subfolders of `folder`, since studies come as nested folders of patients, studies and
/// series. Skips unreadable folders, and links to folders.
std::vector<fs::path> dicom_files_below(const fs::path& folder)
{
    constexpr int MAX_DEPTH = 8;
    std::vector<fs::path> paths;
    std::error_code error;
    size_t entries = 0;
    for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
         !error && at != end && entries < MAX_FILES; at.increment(error), ++entries) {
        const bool is_hidden = at->path().filename().string().starts_with('.');
        if ((is_hidden || at.depth() >= MAX_DEPTH) && at->is_directory(error)) at.disable_recursion_pending();
        if (!is_hidden && is_dicom(at->path())) paths.push_back(at->path());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
}

/// Reads all files. Files that cannot be part of a volume, such as reports or colour pictures, go into `left_out`.
std::vector<DicomFile> read_all(const std::vector<fs::path>& paths, std::vector<std::string>& left_out)
{
    std::vector<DicomFile> files;
    for (const fs::path& path : paths) {
        try {
            if (auto file = read_dicom_file(path)) files.push_back(std::move(*file));
        } catch (const Error& error) {
            left_out.emplace_back(error.what());
        }
    }
    return files;
}

/// Returns the voxel type that holds the intensities of all slices.
VoxelType type_of(const std::vector<DicomFile>& files, const std::vector<DicomSlice>& slices)
{
    const Rescale& first = files[slices[0].file].frames[slices[0].frame].rescale;
    const VoxelType stored = files[slices[0].file].type;
    for (const DicomSlice& slice : slices) {
        const Rescale& rescale = files[slice.file].frames[slice.frame].rescale;
        // PET states a slope for each slice.
        if (rescale.slope != first.slope || rescale.intercept != first.intercept) {
            return bytes_of(stored) <= 2 ? VoxelType::float32 : VoxelType::float64;
        }
    }
    return rescaled_type(stored, first);
}

/// The files of the volume, and the arrangement of their slices.
struct Opened {
    std::vector<DicomFile> files{};
    DicomVolume volume{};
};

/// Opens the series of the file. If the series forms no volume and the file has many frames, opens only this file.
Opened open_file(const fs::path& path, DicomFile&& file, const OpenOptions& options)
{
    const std::string where = path.string();
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    std::vector<std::string> left_out;
    std::vector<DicomFile> files = read_all(dicom_files_in(folder), left_out);
    std::erase_if(files, [&](const DicomFile& other) { return other.series_uid != file.series_uid; });
    const size_t of_series = files.size();
    if (file.frames.size() > 1 && of_series > 1) {
        try {
            DicomVolume volume = arrange_slices(where, files, options);
            return {std::move(files), std::move(volume)};
        } catch (const Error&) {
            files.clear();
        }
    }
    if (files.empty()) files.push_back(std::move(file));
    DicomVolume volume = arrange_slices(where, files, options);
    if (files.size() < of_series)
        volume.info.warnings.push_back(
            sentence("one of the ", of_series, " files of its series is read; the others do not continue it"));
    return {std::move(files), std::move(volume)};
}

Opened open_folder(const fs::path& path, const std::vector<fs::path>& paths, const OpenOptions& options,
                   std::vector<std::string>& left_out)
{
    const std::string where = path.string();
    std::vector<DicomFile> files = read_all(paths, left_out);
    if (files.empty()) {
        fail(where, ": holds ", paths.size(), " DICOM files, but none with an image; expected at least one",
             left_out.empty() ? std::string() : " (" + left_out[0] + ")");
    }
    files = choose_series(where, std::move(files), options);
    DicomVolume volume = arrange_slices(where, files, options);
    return {std::move(files), std::move(volume)};
}

}  // namespace

std::unique_ptr<VolumeSource> open_dicom(const fs::path& path, const OpenOptions& options)
{
    std::error_code ignored;
    const bool is_folder = fs::is_directory(path, ignored);
    const std::string where = path.string();
    Opened opened;
    std::vector<std::string> left_out;
    if (!is_folder) {
        if (!is_dicom(path)) return nullptr;
        std::optional<DicomFile> file = read_dicom_file(path);
        if (!file && !has_preamble(open_input_file(path))) return nullptr;
        if (!file)
            fail(where, ": is a DICOM file without Pixel Data; expected an image, or the folder that holds the images");
        opened = open_file(path, std::move(*file), options);
    } else {
        std::vector<fs::path> paths = dicom_files_in(path);
        const bool are_images = std::any_of(paths.begin(), paths.end(), [](const fs::path& each) {
            return each.filename() != "DICOMDIR";  // a directory of the files below
        });
        if (!are_images) paths = dicom_files_below(path);
        if (paths.empty()) return nullptr;
        opened = open_folder(path, paths, options, left_out);
    }
    std::vector<DicomFile>& files = opened.files;
    DicomVolume& volume = opened.volume;
    VolumeInfo& info = volume.info;
    info.name = (is_folder && !path.has_filename() ? path.parent_path() : path).filename().string();
    info.format = "dicom";
    info.type = type_of(files, volume.slices);
    static_cast<void>(voxel_count(info));
    if (!left_out.empty()) {
        info.warnings.push_back(
            sentence(counted(left_out.size(), "file"), " ignored, the first because ", left_out[0]));
    }
    const DicomFile& first = files[volume.slices[0].file];
    if (first.is_inverted) info.warnings.emplace_back("low values are bright (MONOCHROME1); intensities are inverted");
    if (!is_folder && files.size() > 1) {
        info.warnings.push_back(
            sentence("one file of a series was opened; all ", files.size(), " files of the series are read"));
    }
    return std::make_unique<DicomSource>(std::move(info), std::move(files), std::move(volume.slices));
}

}  // namespace shvr
