#pragma once
// Checks the headers of JPEG pictures within a DICOM file (ITU-T T.81, annex B): GDCM's decoder terminates the program
// when it meets bytes between two segments, an unknown version of JFIF, or an unexpected depth. Pictures that pass are
// safe: GDCM decodes or refuses them. Any thread.

#include <span>

#include "engine/formats/dicom/dicom_layout.h"

namespace shvr {

/// Whether `transfer_syntax` stands for JPEG pictures as in T.81, or for JPEG-LS pictures (T.87).
bool is_jpeg(const std::string& transfer_syntax);

/// Fails if a fragment of Pixel Data begins a picture whose header is damaged or does not state `columns` x `rows` grey
/// pixels; or if the first fragment does not begin a picture.
void check_jpeg_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t columns,
                        int64_t rows);

}  // namespace shvr
