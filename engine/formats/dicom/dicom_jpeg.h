#pragma once
// Checks the headers of JPEG pictures within a DICOM file (ITU-T T.81, annex B): GDCM's decoder terminates the program
// on bytes between two segments, on a version of JFIF it does not know, and on depths it does not expect. Pictures that
// pass are safe to decode: GDCM decodes or refuses them. Any thread.

#include <span>

#include "engine/formats/dicom/dicom_layout.h"

namespace shvr {

/// Whether pixels of that transfer syntax are JPEG pictures of the kinds of T.81, or of JPEG-LS (T.87).
bool is_jpeg(const std::string& transfer_syntax);

/// Fails if a fragment of Pixel Data begins a picture whose header is damaged, or not of that many grey pixels; or if
/// the first fragment does not begin a picture.
void check_jpeg_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t columns,
                        int64_t rows);

}  // namespace shvr
