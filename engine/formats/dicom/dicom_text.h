#pragma once
// Texts of DICOM files in UTF-8. Any thread may call this.

#include <string>
#include <string_view>

namespace shvr {

/// `bytes` in the encoding that Specific Character Set (PS3.5, 6.1.2) names; UTF-8 as it is, whatever is named, and
/// Latin-1 where nothing known is. The result is always valid UTF-8.
std::string dicom_text(std::string_view bytes, std::string_view character_set);

}  // namespace shvr
