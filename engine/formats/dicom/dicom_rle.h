#pragma once
// Checks the headers of run-length encoded pictures within a DICOM file (PS3.5, annex G.5): GDCM trusts the number of
// segments that a header states, and reads that many offsets, even beyond the header. Pictures that pass are decoded or
// refused safely. Any thread.

#include <span>

#include "engine/formats/dicom/dicom_layout.h"

namespace shvr {

bool is_rle(const std::string& transfer_syntax);

/// Fails unless each fragment of Pixel Data begins with the header of a picture with one sample per pixel, of
/// `pixel_bytes` bytes: one segment per byte, the segments one after another within the fragment.
void check_rle_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t pixel_bytes);

}  // namespace shvr
