#include "tools/report/html.h"

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/image_file.h"

namespace shvr::report {

std::string escaped(std::string_view text)
{
    std::string markup;
    for (const char character : text) {
        switch (character) {
            case '&': markup += "&amp;"; break;
            case '<': markup += "&lt;"; break;
            case '>': markup += "&gt;"; break;
            case '"': markup += "&quot;"; break;
            case '\'': markup += "&#39;"; break;
            default: markup += uint8_t(character) < 0x20 && character != '\n' && character != '\t' ? '?' : character;
        }
    }
    return markup;
}

std::string base64(std::span<const std::byte> bytes)
{
    constexpr char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](size_t k) { return i + k < bytes.size() ? std::to_integer<uint32_t>(bytes[i + k]) : 0u; };
        const uint32_t three = at(0) << 16 | at(1) << 8 | at(2);
        for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? DIGITS[three >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

std::string source_of(const Image8& image)
{
    return "data:image/png;base64," + base64(encode_png(image, "picture of a page"));
}

std::string page(std::string_view title, std::string_view style, std::string_view body)
{
    return sentence("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>", escaped(title),
                    "</title>\n<style>\n", style, "</style>\n</head>\n<body>\n", body, "</body>\n</html>\n");
}

void write_text(const std::filesystem::path& path, std::string_view text)
{
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace shvr::report
