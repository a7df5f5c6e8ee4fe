#include "engine/session/words/typed_number.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"

namespace shvr {

std::optional<double> typed_number(std::string_view text)
{
    std::string word(trimmed(text));
    const auto comma = std::ranges::find(word, ',');
    if (comma != word.end()) {
        if (word.find('.') != std::string::npos) return std::nullopt;
        *comma = '.';  // a second comma stays, and is refused
    }
    const std::optional<double> number = number_of(word);
    return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<int64_t> typed_whole(std::string_view text)
{
    return whole_of(trimmed(text));
}

bool may_become_number(std::string_view text)
{
    return typed_number(std::string(text) + '0').has_value();
}

bool may_become_whole(std::string_view text)
{
    return typed_whole(std::string(text) + '0').has_value();
}

std::string with_decimal_point(std::string_view text)
{
    std::string changed(text);
    if (typed_number(text)) std::ranges::replace(changed, ',', '.');
    return changed;
}

}  // namespace shvr
