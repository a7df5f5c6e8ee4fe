#pragma once
// Decides which slices of which DICOM files form a volume, their order, and the volume's position. For
// source_dicom.cpp. Any thread.

#include <string>
#include <vector>

#include "engine/formats/dicom/dicom_file.h"

namespace shvr {

struct DicomSlice {
    size_t file = 0;  ///< index among the files
    size_t frame = 0;
};

/// Slices of one size and direction, from first to last, and the volume's description, which still lacks type and name.
struct DicomVolume {
    VolumeInfo info{};
    std::vector<DicomSlice> slices{};
};

/// Returns the files of the only series, or of the series that the options choose. `where` names the input in messages.
std::vector<DicomFile> choose_series(const std::string& where, std::vector<DicomFile> files,
                                     const OpenOptions& options);

/// Arranges the slices of `files`, at least one and all of the same series, as a volume.
DicomVolume arrange_slices(const std::string& where, const std::vector<DicomFile>& files, const OpenOptions& options);

/// For messages: "1 slice", "2 slices".
std::string counted(size_t number, const char* thing);

}  // namespace shvr
