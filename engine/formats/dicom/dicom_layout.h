#pragma once
// The lengths that a DICOM file states, against what it holds, without reading a value (PS3.5, 7.1 to 7.5). GDCM
// believes lengths: it takes up to 4 GiB of memory for a value before it finds that the file ends, and follows
// sequences in sequences until its stack is full. What passes here it can read. Any thread may call this.

#include <cstdint>
#include <optional>
#include <string>

#include "engine/formats/voxel_bytes.h"

namespace shvr {

struct DicomLayout {
    std::string transfer_syntax;  ///< its UID
    int64_t pixel_bytes = 0;      ///< of Pixel Data, as stored; 0 where there is none
    bool is_encapsulated = false;
};

/// Nothing where `file` is no DICOM file. Fails where lengths do not fit in each other or in the file.
std::optional<DicomLayout> check_dicom_layout(const InputFile& file);

}  // namespace shvr
