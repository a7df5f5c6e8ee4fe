#include "engine/formats/dicom/dicom_text.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "engine/base/text.h"

namespace shvr {
namespace {

/// The defined terms of Specific Character Set, with iconv's names. Files may also spell them as "ISO 2022 IR 100".
constexpr std::pair<std::string_view, const char*> ENCODINGS[] = {
    {"ISO_IR 100", "ISO-8859-1"},  {"ISO_IR 101", "ISO-8859-2"},  {"ISO_IR 109", "ISO-8859-3"},
    {"ISO_IR 110", "ISO-8859-4"},  {"ISO_IR 144", "ISO-8859-5"},  {"ISO_IR 127", "ISO-8859-6"},
    {"ISO_IR 126", "ISO-8859-7"},  {"ISO_IR 138", "ISO-8859-8"},  {"ISO_IR 148", "ISO-8859-9"},
    {"ISO_IR 203", "ISO-8859-15"}, {"ISO_IR 166", "TIS-620"},     {"ISO_IR 13", "SHIFT_JIS"},
    {"ISO_IR 87", "ISO-2022-JP"},  {"ISO_IR 159", "ISO-2022-JP"}, {"ISO_IR 149", "EUC-KR"},
    {"ISO_IR 58", "GB2312"},       {"GB18030", "GB18030"},        {"GBK", "GBK"}};

bool is_utf8(std::string_view bytes)
{
    for (size_t i = 0; i < bytes.size();) {
        const auto first = uint8_t(bytes[i]);
        const size_t more = first < 0x80 ? 0 : first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
        if ((first >= 0x80 && first < 0xc2) || first > 0xf4 || i + more >= bytes.size()) return false;
        uint32_t code = more == 0 ? first : first & (0x3fu >> more);
        for (size_t k = 1; k <= more; ++k) {
            const auto next = uint8_t(bytes[i + k]);
            if ((next & 0xc0u) != 0x80u) return false;
            code = code << 6 | (next & 0x3fu);
        }
        constexpr std::array<uint32_t, 4> LEAST{0, 0x80, 0x800, 0x10000};
        if (code < LEAST[more] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return false;
        i += more + 1;
    }
    return true;
}

const char* encoding_of(std::string_view character_set)
{
    // If a file names several character sets, the last one is used for all characters beyond ASCII.
    std::string term(trimmed(character_set.substr(character_set.rfind('\\') + 1)));
    term = std::string(trimmed(std::string_view(term).substr(0, term.find('\0'))));
    if (term.starts_with("ISO 2022 IR")) term = "ISO_IR" + term.substr(11);
    for (const auto& [name, encoding] : ENCODINGS)
        if (term == name) return encoding;
    return nullptr;
}

std::optional<std::string> converted(std::string_view bytes, const char* encoding)
{
    const iconv_t converter = ::iconv_open("UTF-8", encoding);
    if (converter == iconv_t(-1)) return {};
    std::string input(bytes), output(4 * bytes.size() + 16, '\0');
    char* from = input.data();
    char* to = output.data();
    size_t left = input.size(), room = output.size();
    const bool is_valid = ::iconv(converter, &from, &left, &to, &room) != size_t(-1);
    ::iconv_close(converter);
    if (!is_valid) return {};
    output.resize(output.size() - room);
    return output;
}

std::string from_latin_1(std::string_view bytes)
{
    std::string text;
    for (const char each : bytes) {
        const auto byte = uint8_t(each);
        if (byte < 0x80) {
            text += each;
        } else {
            text += char(0xc0u | byte >> 6);
            text += char(0x80u | (byte & 0x3fu));
        }
    }
    return text;
}

}  // namespace

std::string dicom_text(std::string_view bytes, std::string_view character_set)
{
    const bool has_escapes = bytes.find('\x1b') != std::string_view::npos;
    if (!has_escapes && is_utf8(bytes)) return std::string(bytes);
    if (const char* const encoding = encoding_of(character_set))
        if (std::optional<std::string> text = converted(bytes, encoding)) return *std::move(text);
    return from_latin_1(bytes);
}

}  // namespace shvr
