#pragma once
// Decides which slices of which DICOM files form a volume, in which order, and where it lies. For source_dicom.cpp. Any
// thread.

#include <string>
#include <vector>

#include "engine/formats/dicom/dicom_file.h"

namespace shvr {

struct DicomSlice {
    size_t file = 0;  ///< index among the files
    size_t frame = 0;
};

/// Slices of one size and direction, from first to last; and the volume's description, except its type and name.
struct DicomVolume {
    VolumeInfo info{};
    std::vector<DicomSlice> slices{};
};

/// The files of the only series, or of the one that the options choose. `where`: for messages.
std::vector<DicomFile> choose_series(const std::string& where, std::vector<DicomFile> files,
                                     const OpenOptions& options);

/// Makes a volume of `files`, which must all be of one series; at least one.
DicomVolume arrange_slices(const std::string& where, const std::vector<DicomFile>& files, const OpenOptions& options);

/// For messages: "1 slice", "2 slices".
std::string counted(size_t number, const char* thing);

}  // namespace shvr
