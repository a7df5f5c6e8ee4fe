#include "engine/formats/dicom/dicom_rle.h"

#include <array>

#include "engine/base/error.h"

namespace shvr {

bool is_rle(const std::string& transfer_syntax)
{
    return transfer_syntax == "1.2.840.10008.1.2.5";
}

void check_rle_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t pixel_bytes)
{
    constexpr int64_t HEADER_BYTES = 64;
    for (const DicomLayout::Fragment& fragment : fragments) {
        std::array<uint8_t, HEADER_BYTES> header{};
        if (fragment.bytes < HEADER_BYTES ||
            file.read_some(fragment.at, std::as_writable_bytes(std::span(header))) != header.size())
            fail(file.path.string(), ": a run-length encoded picture at byte ", fragment.at, " has ", fragment.bytes,
                 " bytes; expected a header of ", HEADER_BYTES, " and more");
        const auto number = [&](int64_t i) {
            const uint8_t* const at = header.data() + 4 * i;
            return int64_t(uint32_t(at[0]) | uint32_t(at[1]) << 8 | uint32_t(at[2]) << 16 | uint32_t(at[3]) << 24);
        };
        if (number(0) != pixel_bytes)
            fail(file.path.string(), ": a run-length encoded picture at byte ", fragment.at, " has ", number(0),
                 " segments; expected ", pixel_bytes, ", one for each byte of a pixel");
        for (int64_t i = 1; i <= pixel_bytes; ++i) {
            const int64_t least = i == 1 ? HEADER_BYTES : number(i - 1), most = i == 1 ? least : fragment.bytes;
            if (number(i) < least || number(i) > most)
                fail(file.path.string(), ": segment ", i, " of a run-length encoded picture begins at byte ", number(i),
                     " of it; expected ", least, i == 1 ? "" : " to ", i == 1 ? "" : std::to_string(most));
        }
    }
}

}  // namespace shvr
