#pragma once
// Decodes JPEG 2000 pictures within a DICOM file (ITU-T T.800) by OpenJPEG directly. GDCM also uses OpenJPEG, but reads
// beyond the picture's end if a stated length says so, and writes out of bounds at an unexpected precision. Any thread.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace shvr {

bool is_jpeg_2000(const std::string& transfer_syntax);

/// Decodes `picture`, a codestream or a JP2 file, into `pixels`: `columns` x `rows` integers of 1, 2 or 4 bytes. Fails,
/// naming `subject`, if the picture is damaged, has another size, or has more bits than these integers hold.
void decode_jpeg_2000(const std::string& subject, std::span<const std::byte> picture, int64_t columns, int64_t rows,
                      std::span<std::byte> pixels);

}  // namespace shvr
