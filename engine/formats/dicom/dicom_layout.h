#pragma once
// Checks the lengths that a DICOM file states against its size, without reading any value (PS3.5, 7.1 to 7.5). GDCM
// trusts lengths: it allocates up to 4 GiB for a value before it notices the end of the file, and follows nested
// sequences until its stack overflows. GDCM can safely read files that pass this check. Any thread may call this.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/formats/voxel_bytes.h"

namespace shvr {

struct DicomLayout {
    std::string transfer_syntax;  ///< its UID
    int64_t pixel_bytes = 0;      ///< of Pixel Data, as stored; 0 if there is none
    int64_t pixels_at = 0;        ///< where they begin, if not encapsulated
    bool is_big_endian = false;
    bool pixels_are_words = false;  ///< of type OW: two bytes in the file's order, though a pixel may be one byte
    bool is_encapsulated = false;
    struct Fragment {
        int64_t at = 0, bytes = 0;
    };
    std::vector<Fragment> fragments;  ///< of encapsulated Pixel Data, without the table of offsets before them
};

/// Nothing if `file` is not a DICOM file. Fails if lengths do not fit into each other or into the file.
std::optional<DicomLayout> check_dicom_layout(const InputFile& file);

}  // namespace shvr
