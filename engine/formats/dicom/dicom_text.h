#pragma once
// Converts texts of DICOM files to UTF-8. Any thread may call this.

#include <string>
#include <string_view>

namespace shvr {

/// Converts `bytes` from the encoding that Specific Character Set (PS3.5, 6.1.2) names. Text that is valid UTF-8 is
/// kept, whatever encoding is named. Unknown encodings are read as Latin-1. The result is always valid UTF-8.
std::string dicom_text(std::string_view bytes, std::string_view character_set);

}  // namespace shvr
