#pragma once
// Volumes whose slices are pages of TIFF files. For source_tiff.cpp and source_tiff_folder.cpp.

#include "engine/formats/tiff/tiff_blocks.h"
#include "engine/formats/tiff/tiff_choice.h"
#include "engine/volume/source.h"

namespace shvr {

/// Everything needed to read the voxels.
struct TiffVolume {
    VolumeInfo info{};
    TiffLayout layout{};  ///< layout of every slice
    TiffRecipe recipe{};
    std::vector<std::filesystem::path> files{};
    std::vector<TiffSlice> slices{};  ///< one for each z
};

/// Makes a source that opens files when it reads from them. `file`, if given, is the only file, already open.
std::unique_ptr<VolumeSource> make_tiff_source(TiffVolume volume, std::unique_ptr<const TiffFile> file);

/// Sets `info.type` and `recipe` for the chosen channel of each pixel; warns about any change of values. `description`
/// is that of the file.
void apply_recipe(TiffVolume& volume, const TiffPage& page, const TiffPixelChannel& channel,
                  const TiffDescription& description);

/// Returns the pages that may be slices: all except smaller copies and masks, or all pages if only such pages exist.
std::vector<uint32_t> pages_to_show(const TiffDirectories& directories);

/// One file, whatever its name.
std::unique_ptr<VolumeSource> open_tiff_file(const std::filesystem::path& path, const OpenOptions& options);
/// Opens a folder with one slice per file; null if it contains no file named *.tif or *.tiff.
std::unique_ptr<VolumeSource> open_tiff_folder(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace shvr
