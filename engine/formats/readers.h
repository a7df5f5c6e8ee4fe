#pragma once
// The readers that `open_volume` tries in turn. Each looks at the file and returns null if the format is not its own,
// returns the volume, or fails if the format is its own but the file is damaged. Any thread may call these.

#include "engine/volume/source.h"

namespace shvr {

/// Opens OME-Zarr images of versions 0.1 to 0.5, projects, and bare Zarr arrays (versions 2 and 3): folders with
/// .zattrs, .zgroup, .zarray or zarr.json; archives of such a folder's content (.ozx, .zip), and paths into them.
std::unique_ptr<VolumeSource> open_ome_zarr(const std::filesystem::path& path, const OpenOptions& options);
/// Opens TIFF and BigTIFF, recognised by their first bytes or their extension, and folders of TIFFs.
std::unique_ptr<VolumeSource> open_tiff(const std::filesystem::path& path, const OpenOptions& options);

/// Opens NRRD and NHDR, encodings raw and gzip, recognised by their first bytes or their extension.
std::unique_ptr<VolumeSource> open_nrrd(const std::filesystem::path& path, const OpenOptions& options);

/// Opens MetaImage, MHD and MHA, recognised by their first field or their extension.
std::unique_ptr<VolumeSource> open_mhd(const std::filesystem::path& path, const OpenOptions& options);

/// Opens NIfTI-1 and NIfTI-2 (.nii, .nii.gz, .hdr with .img), recognised by their first bytes or their extension.
std::unique_ptr<VolumeSource> open_nifti(const std::filesystem::path& path, const OpenOptions& options);

/// Opens DICOM: a folder of slices, one slice of a series, or one file with many frames.
std::unique_ptr<VolumeSource> open_dicom(const std::filesystem::path& path, const OpenOptions& options);

/// Opens PNG, BMP and JPEG, recognised by their first bytes: a folder of slices, or one file as one slice.
std::unique_ptr<VolumeSource> open_png(const std::filesystem::path& path, const OpenOptions& options);
std::unique_ptr<VolumeSource> open_bmp(const std::filesystem::path& path, const OpenOptions& options);
std::unique_ptr<VolumeSource> open_jpeg(const std::filesystem::path& path, const OpenOptions& options);

/// Opens raw voxels with a side-car, by the path of either file; source_side_car.cpp lists the kinds of side-cars.
std::unique_ptr<VolumeSource> open_raw_with_side_car(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace shvr
