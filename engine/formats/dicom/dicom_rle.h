#pragma once
// Checks the headers of run-length encoded pictures within a DICOM file (PS3.5, annex G.5). The check is needed because
// GDCM trusts the number of segments that a header states, and reads that many offsets, even beyond the header.
// Pictures that pass are safe: GDCM either decodes or refuses them. Any thread.

#include <span>

#include "engine/formats/dicom/dicom_layout.h"

namespace shvr {

bool is_rle(const std::string& transfer_syntax);

/// Fails unless each fragment of Pixel Data begins with the header of a picture with one sample of `pixel_bytes` bytes
/// per pixel. Such a header lists one segment per byte of a pixel, in order and inside the fragment.
void check_rle_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t pixel_bytes);

}  // namespace shvr
