#pragma once
// Checks the headers of JPEG pictures within a DICOM file (ITU-T T.81, annex B). The checks are needed because GDCM's
// decoder terminates the program at bytes between two segments, an unknown JFIF version, or an unexpected depth.
// Pictures that pass are safe: GDCM either decodes or refuses them. Any thread may call these.

#include <span>

#include "engine/formats/dicom/dicom_layout.h"

namespace shvr {

/// Whether `transfer_syntax` is one of the UIDs for JPEG pictures (T.81) or JPEG-LS pictures (T.87).
bool is_jpeg(const std::string& transfer_syntax);

/// Fails if the first fragment of Pixel Data does not begin a picture, or if the header of any picture is damaged or
/// does not state `columns` x `rows` grey pixels.
void check_jpeg_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t columns,
                        int64_t rows);

}  // namespace shvr
