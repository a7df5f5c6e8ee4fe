#pragma once
// The readers that `open_volume` tries in turn. Each looks at the file and returns null ("not mine"), returns the
// volume, or fails ("mine, but broken"). Any thread may call them.

#include "engine/volume/source.h"

namespace shvr {

/// OME-Zarr images of versions 0.1 to 0.5, projects, and bare Zarr arrays (versions 2 and 3): folders with a .zattrs,
/// .zgroup, .zarray or zarr.json; archives of such a folder's content (.ozx, .zip), and paths into archives.
std::unique_ptr<VolumeSource> open_ome_zarr(const std::filesystem::path& path, const OpenOptions& options);
/// TIFF and BigTIFF, by their first bytes or their extension, and folders of TIFFs.
std::unique_ptr<VolumeSource> open_tiff(const std::filesystem::path& path, const OpenOptions& options);

/// NRRD and NHDR, encodings raw and gzip, by their first bytes or their extension.
std::unique_ptr<VolumeSource> open_nrrd(const std::filesystem::path& path, const OpenOptions& options);

/// MetaImage, MHD and MHA, by their first field or their extension.
std::unique_ptr<VolumeSource> open_mhd(const std::filesystem::path& path, const OpenOptions& options);

/// NIfTI-1 and NIfTI-2: .nii, .nii.gz, .hdr with .img, by their first bytes or their extension.
std::unique_ptr<VolumeSource> open_nifti(const std::filesystem::path& path, const OpenOptions& options);

/// DICOM: a folder of slices, one slice of a series, or one file of many frames.
std::unique_ptr<VolumeSource> open_dicom(const std::filesystem::path& path, const OpenOptions& options);

/// PNG, BMP and JPEG: a folder of such slices, or one file as one slice, by their first bytes.
std::unique_ptr<VolumeSource> open_png(const std::filesystem::path& path, const OpenOptions& options);
std::unique_ptr<VolumeSource> open_bmp(const std::filesystem::path& path, const OpenOptions& options);
std::unique_ptr<VolumeSource> open_jpeg(const std::filesystem::path& path, const OpenOptions& options);

/// Raw voxels described by a side-car; opens the path of either file (source_side_car.cpp lists the side-cars).
std::unique_ptr<VolumeSource> open_raw_with_side_car(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace shvr
