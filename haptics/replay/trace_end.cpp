#include "haptics/replay/trace_end.h"

#include <algorithm>
#include <cstdint>

#include "engine/base/json.h"

namespace shvr {
namespace {

constexpr std::string_view BLANK = " \t\r\n";

/// FNV-1a
uint64_t hash_of(std::string_view text)
{
    uint64_t hash = 14695981039346656037ull;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
    return hash;
}

std::string in_hex(uint64_t number)
{
    std::string digits;
    for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[number >> shift & 15];
    return digits;
}

int64_t lines_of(std::string_view text)
{
    return std::ranges::count(text, '\n');
}

}  // namespace

std::string trace_end(std::string_view text)
{
    return sentence("{\"end\":{\"lines\":", lines_of(text), ",\"hash\":\"", in_hex(hash_of(text)), "\"}}\n");
}

std::string_view without_trace_end(std::string_view text, const std::string& origin)
{
    const size_t last = text.find_last_not_of(BLANK);
    const size_t begin = text.rfind('\n', last) + 1;  // 0 if there is no line break
    const std::string_view before = text.substr(0, begin), line = text.substr(begin, last + 1 - begin);
    if (!line.starts_with("{\"end\":") || !line.ends_with("}}"))
        fail(origin, " has no end line after its ", lines_of(text),
             " lines; expected {\"end\":{...}} as the last one: the file was cut off or changed, copy it anew");
    const JsonDocument document(line, sentence(origin, ":", lines_of(before) + 1));
    const JsonNode end = document.root()["end"];
    document.root().allow({"end"});
    end.allow({"lines", "hash"});
    const int64_t lines = end.required("lines", "the number of lines before it").whole(0, INT64_MAX);
    if (lines != lines_of(before))
        fail(origin, " has ", lines_of(before), " lines before its end line, which counts ", lines,
             "; expected as many: lines were lost or added, copy it anew");
    const JsonNode hash = end.required("hash", "16 hexadecimal digits");
    if (!hash.is(in_hex(hash_of(before))))
        fail(origin, ": the hash of its lines is ", in_hex(hash_of(before)), ", and its end line says ", hash.dump(),
             "; expected the same: something in it was changed, copy it anew");
    return before;
}

}  // namespace shvr
