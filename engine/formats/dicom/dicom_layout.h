#pragma once
// Checks the lengths that a DICOM file states against the file's size, without reading any value (PS3.5, 7.1 to 7.5).
// GDCM trusts lengths: it allocates up to 4 GiB for a value before it notices the end of the file, and recurses into
// nested sequences until its stack overflows. Files that pass are safe for GDCM. Any thread may call these.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/formats/voxel_bytes.h"

namespace shvr {

struct DicomLayout {
    std::string transfer_syntax;  ///< its UID
    int64_t pixel_bytes = 0;      ///< size of Pixel Data as stored; 0: the file has none
    int64_t pixels_at = 0;        ///< offset of the pixels, if they are not encapsulated
    bool is_big_endian = false;
    bool pixels_are_words = false;  ///< pixels have the type OW: 16-bit words in the file's byte order, even if a pixel
                                    ///< is one byte
    bool is_encapsulated = false;
    enum class Numbers { whole, float32, float64 };
    Numbers numbers = Numbers::whole;  ///< whole: Pixel Data; others: Float or Double Float Pixel Data
    /// The element number, in group 7fe0, of the element that holds the pixels.
    uint16_t pixel_element() const
    {
        return numbers == Numbers::whole ? 0x10 : numbers == Numbers::float32 ? 0x8 : 0x9;
    }
    struct Fragment {
        int64_t at = 0, bytes = 0;
    };
    std::vector<Fragment> fragments;  ///< the fragments of encapsulated Pixel Data, except the offset table
};

bool has_preamble(const InputFile& file);
/// Whether `file` begins like a DICOM file: with the preamble or, in old files, with the first elements of a data set.
bool begins_as_dicom(const InputFile& file);

/// Returns null if `file` is not a DICOM file. Fails if its lengths contradict each other or the size of the file.
std::optional<DicomLayout> check_dicom_layout(const InputFile& file);

}  // namespace shvr
