#pragma once
// Checks the headers of JPEG pictures within a DICOM file (ITU-T T.81, annex B): GDCM's decoder ends the program at
// bytes between two segments, at a version of JFIF it does not know, and at depths it does not expect. What passes it
// decodes, or refuses. Any thread.

#include <span>

#include "engine/formats/dicom/dicom_layout.h"

namespace shvr {

/// Whether pixels of that transfer syntax are JPEG pictures of the kinds of T.81, or of JPEG-LS (T.87).
bool is_jpeg(const std::string& transfer_syntax);

/// Fails where a fragment of Pixel Data begins a picture whose header is damaged, or is not one of so many grey pixels;
/// or where the first one begins none.
void check_jpeg_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t columns,
                        int64_t rows);

}  // namespace shvr
