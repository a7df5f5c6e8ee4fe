#include "engine/pages/html.h"

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/image_file.h"

namespace shvr::report {

namespace {

/// The CSS that all pages share, for light and dark mode.
constexpr const char* COMMON_STYLE = R"(:root{color-scheme:light dark;--paper:#fff;--ink:#222;--faint:#5a5f66;
--line:#d8dadd;--field:#eef0f2;--good:#14632b;--bad:#a3161b;--perhaps:#8a5a00;--link:#0b57a4}
@media (prefers-color-scheme:dark){:root{--paper:#17191c;--ink:#dcdfe3;--faint:#9aa1a9;--line:#3a3f45;--field:#262a2f;
--good:#6fcf8b;--bad:#ff8b8b;--perhaps:#e9b44c;--link:#7db7f0}}
body{font:14px/1.45 sans-serif;margin:1em auto;max-width:1500px;padding:0 1em;background:var(--paper);color:var(--ink)}
a{color:var(--link)}h2{margin:1.4em 0 .3em}svg{max-width:100%;height:auto}
table{border-collapse:collapse;margin:.5em 0}td,th{padding:.15em .8em;text-align:right;border-bottom:1px solid
var(--line)}td:first-child,th:first-child{text-align:left;white-space:nowrap}
figure{display:inline-block;margin:.3em .6em .3em 0;vertical-align:top}figcaption{font-size:12px;color:var(--faint)}
code{background:var(--field);padding:.1em .3em;user-select:all}summary{cursor:pointer}
)";

}  // namespace

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
                    "</title>\n<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n", COMMON_STYLE, style,
                    "</style>\n</head>\n<body>\n", body, "</body>\n</html>\n");
}

void make_folder(const std::filesystem::path& path)
{
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) fail(path.string(), ": cannot be created: ", error.message(), "; expected a folder to write into");
}

void write_text(const std::filesystem::path& path, std::string_view text)
{
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace shvr::report
