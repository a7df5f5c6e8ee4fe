#pragma once
// JPEG 2000 pictures within a DICOM file (ITU-T T.800), decoded by OpenJPEG: GDCM, which calls it too, follows lengths
// beyond the picture's end and writes beyond its own memory where the precision is not the one it expects. Any thread.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace shvr {

bool is_jpeg_2000(const std::string& transfer_syntax);

/// Decodes `picture`, a codestream or a JP2 file, into `pixels`: `columns` x `rows` integers of 1, 2 or 4 bytes. Fails,
/// naming `subject`, where the picture is damaged, of another size, or of more bits than these have.
void decode_jpeg_2000(const std::string& subject, std::span<const std::byte> picture, int64_t columns, int64_t rows,
                      std::span<std::byte> pixels);

}  // namespace shvr
