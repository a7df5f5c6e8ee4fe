#include "engine/session/words/number_words.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace shvr {

std::string number_in_words(double value)
{
    constexpr double MAX_EXACT = 9007199254740992.0;  // 2^53
    constexpr double SMALLEST = 1e-4, LARGEST = 1e15;
    constexpr int DIGITS = 4;
    const double size = std::abs(value);
    if (value == std::floor(value) && size <= MAX_EXACT) return std::to_string(int64_t(value));
    char text[64];
    if (!(size >= SMALLEST && size < LARGEST)) {
        std::snprintf(text, sizeof text, "%.*g", DIGITS, value);
        return text;
    }
    const int decimals = std::max(DIGITS - 1 - int(std::floor(std::log10(size))), 0);
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    std::string words = text;
    if (words.find('.') == std::string::npos) return words;
    words.erase(words.find_last_not_of('0') + 1);
    if (words.back() == '.') words.pop_back();
    return words;
}

std::string capitalised(std::string_view text)
{
    std::string capital(text);
    if (!capital.empty() && capital[0] >= 'a' && capital[0] <= 'z') capital[0] = char(capital[0] - 'a' + 'A');
    return capital;
}

}  // namespace shvr
