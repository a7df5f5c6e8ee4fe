#include "engine/annotation/patterns/stated_axis.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "engine/base/error.h"

namespace shvr {

std::optional<StatedAxis> stated_axis(const std::string& text, const std::string& option)
{
    if (text.empty()) return {};
    std::array<double, 6> numbers{};
    size_t count = 0;
    std::string_view rest = text;
    for (bool is_more = true; is_more; ++count) {
        const std::string_view number = rest.substr(0, rest.find(','));
        is_more = number.size() < rest.size();
        rest.remove_prefix(number.size() + is_more);
        double value = 0.0;
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
        if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(value))
            fail(option, " is '", text, "': found '", number, "'; expected a number");
        if (count < numbers.size()) numbers[count] = value;
    }
    if (count != numbers.size())
        fail(option, " is '", text, "': found ", count,
             " numbers; expected six: a point of the axis and its direction towards the florets, X,Y,Z,DX,DY,DZ");
    const glm::dvec3 direction(numbers[3], numbers[4], numbers[5]);
    const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (!(largest > 0.0)) fail(option, " is '", text, "': the direction is 0,0,0; expected one towards the florets");
    return StatedAxis{{numbers[0], numbers[1], numbers[2]}, glm::normalize(direction / largest)};
}

}  // namespace shvr
