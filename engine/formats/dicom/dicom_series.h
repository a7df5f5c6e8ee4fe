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

/// Slices of one size and direction, from first to last, and the volume's description without its type and name.
struct DicomVolume {
    VolumeInfo info{};
    std::vector<DicomSlice> slices{};
};

/// Returns the files of the only series, or of the series that the options choose. `where`: for messages.
std::vector<DicomFile> choose_series(const std::string& where, std::vector<DicomFile> files,
                                     const OpenOptions& options);

/// Makes a volume of `files`, which must be at least one file, all of one series.
DicomVolume arrange_slices(const std::string& where, const std::vector<DicomFile>& files, const OpenOptions& options);

/// For messages: "1 slice", "2 slices".
std::string counted(size_t number, const char* thing);

}  // namespace shvr
