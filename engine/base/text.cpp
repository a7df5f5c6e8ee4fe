#include "engine/base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "engine/base/error.h"

namespace shvr {
namespace {

bool is_control(char character)
{
    return static_cast<unsigned char>(character) < 0x20 || character == 0x7f;
}

constexpr std::string_view SPACES = " \t\r\n\v\f";

template <class Number>
std::optional<Number> parsed(std::string_view word)
{
    if (word.starts_with('+')) word.remove_prefix(1);
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (word.empty() || error != std::errc() || end != word.data() + word.size()) return {};
    return number;
}

}  // namespace

std::string_view trimmed(std::string_view text)
{
    const size_t first = text.find_first_not_of(SPACES);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(SPACES) - first + 1);
}

std::string lower_case(std::string_view text)
{
    std::string lower(text);
    for (char& character : lower) {
        if (character >= 'A' && character <= 'Z') character = char(character - 'A' + 'a');
    }
    return lower;
}

std::vector<std::string_view> words_of(std::string_view text)
{
    std::vector<std::string_view> words;
    for (;;) {
        const size_t first = text.find_first_not_of(SPACES);
        if (first == std::string_view::npos) return words;
        const size_t end = std::min(text.size(), text.find_first_of(SPACES, first));
        words.push_back(text.substr(first, end - first));
        text.remove_prefix(end);
    }
}

bool has_controls(std::string_view text)
{
    return std::any_of(text.begin(), text.end(), is_control);
}

std::string printable(std::string_view text)
{
    std::string shown(text);
    std::replace_if(shown.begin(), shown.end(), is_control, '?');
    // Replaces U+0080 to U+009F (in UTF-8), too: terminals interpret U+009B like ESC [.
    for (size_t at = 0; at + 1 < shown.size(); ++at)
        if (shown[at] == '\xc2' && static_cast<unsigned char>(shown[at + 1]) >= 0x80 &&
            static_cast<unsigned char>(shown[at + 1]) <= 0x9f)
            shown[at] = shown[at + 1] = '?';
    return shown;
}

std::string in_quotes(std::string_view text)
{
    constexpr size_t LONGEST = 60;
    return "\"" + printable(text.substr(0, LONGEST)) + (text.size() > LONGEST ? "...\"" : "\"");
}

std::string_view take_line(std::string_view& rest)
{
    const size_t end = std::min(rest.size(), rest.find('\n'));
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(rest.size(), end + 1));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::string one_line(std::string_view text)
{
    std::string whole;
    while (!text.empty()) {
        const std::string_view line = take_line(text);
        if (!line.empty()) whole += (whole.empty() ? "" : " ") + std::string(line);
    }
    return whole;
}

std::optional<int64_t> whole_of(std::string_view word)
{
    return parsed<int64_t>(word);
}

std::optional<double> number_of(std::string_view word)
{
    return parsed<double>(word);
}

std::string digits_of(double value)
{
    char digits[32];
    const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), value);
    SHVR_CHECK(error == std::errc());
    return {digits, end};
}

std::string plain_digits_of(double value)
{
    constexpr double SMALLEST = 1e-6, LARGEST = 1e15;
    if (value == 0.0) return "0";  // also -0
    const double size = std::abs(value);
    if (!(size >= SMALLEST && size <= LARGEST)) return digits_of(value);
    char digits[32];  // a sign, a point, at most 6 zeros and 17 digits
    const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), value, std::chars_format::fixed);
    SHVR_CHECK(error == std::errc());
    return {digits, end};
}

std::string digits_of(const glm::dvec3& value)
{
    return digits_of(value.x) + " " + digits_of(value.y) + " " + digits_of(value.z);
}

std::string digits_of(const glm::i64vec3& value)
{
    return sentence(value.x, " ", value.y, " ", value.z);
}

}  // namespace shvr
