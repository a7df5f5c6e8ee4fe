#pragma once
// Checks the headers of run-length encoded pictures within a DICOM file (PS3.5, annex G.5): GDCM believes how many
// segments they state, and reads as many offsets beyond the header. What passes decodes, or is refused. Any thread.

#include <span>

#include "engine/formats/dicom/dicom_layout.h"

namespace shvr {

bool is_rle(const std::string& transfer_syntax);

/// Fails where a fragment of Pixel Data does not begin with the header of a picture of one sample a pixel, of so many
/// bytes each: a segment for each of them, one after another within the fragment.
void check_rle_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t pixel_bytes);

}  // namespace shvr
