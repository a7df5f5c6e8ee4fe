#include "engine/annotation/patterns/sections.h"

#include <charconv>
#include <optional>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

using Parts = std::array<HeadPart, 256>;

std::optional<HeadPart> part_named(std::string_view name)
{
    for (const HeadPart part : HEAD_PARTS)
        if (name == name_of(part)) return part;
    return {};
}

/// Returns the part that a group's name states; none if the name states no part or several.
HeadPart part_in(const std::string& name)
{
    constexpr std::pair<const char*, HeadPart> WORDS[] = {{"abaxial", HeadPart::abaxial},
                                                          {"stem", HeadPart::abaxial},
                                                          {"bract", HeadPart::abaxial},
                                                          {"adaxial", HeadPart::adaxial},
                                                          {"floret", HeadPart::floret}};
    const std::string lower = lower_case(name);
    HeadPart found = HeadPart::none;
    for (const auto& [word, part] : WORDS) {
        if (lower.find(word) == std::string::npos) continue;
        if (found != HeadPart::none && found != part) return HeadPart::none;
        found = part;
    }
    return found;
}

void read_stated(std::string_view stated, const std::string& option, Parts& parts)
{
    const auto refuse = [&](std::string_view found, const std::string& expected) {
        fail(option, " is '", stated, "': found '", found, "'; expected ", expected);
    };
    for (std::string_view rest = stated; !rest.empty();) {
        const std::string_view item = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(rest.size(), item.size() + 1));
        const size_t equals = item.find('=');
        const std::optional<HeadPart> part = part_named(item.substr(0, equals));
        if (!part || equals == std::string_view::npos)
            refuse(item, "abaxial, adaxial or floret, and its groups, such as abaxial=1+4,adaxial=2,floret=3");
        for (std::string_view numbers = item.substr(equals + 1);;) {
            const std::string_view number = numbers.substr(0, numbers.find('+'));
            int group = 0;
            const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), group);
            if (error != std::errc{} || end != number.data() + number.size() || group < 1 || group > 255)
                refuse(number, "a group, 1 to 255");
            if (parts[size_t(group)] != HeadPart::none) refuse(number, "each group once");
            parts[size_t(group)] = *part;
            if (number.size() == numbers.size()) break;
            numbers.remove_prefix(number.size() + 1);
        }
    }
}

bool has(const Parts& parts, HeadPart part)
{
    for (const HeadPart each : parts)
        if (each == part) return true;
    return false;
}

}  // namespace

const char* name_of(HeadPart part)
{
    constexpr const char* NAMES[] = {"none", "abaxial", "adaxial", "floret"};
    return NAMES[size_t(part)];
}

std::string HeadSections::groups_of(HeadPart part) const
{
    std::string text;
    for (size_t group = 1; group < parts.size(); ++group)
        if (parts[group] == part) text += (text.empty() ? "" : "+") + std::to_string(group);
    return text.empty() ? "none" : text;
}

HeadSections head_sections(const std::string& stated, const std::string& option,
                           const std::function<SectionGroup(uint8_t)>& group)
{
    HeadSections sections;
    Parts& parts = sections.parts;
    sections.is_stated = !stated.empty();
    if (sections.is_stated) {
        read_stated(stated, option, parts);
    } else {
        for (int number = 1; number < 256; ++number) {
            parts[size_t(number)] = part_in(group(uint8_t(number)).name);
            sections.is_stated |= parts[size_t(number)] != HeadPart::none;
        }
        const Parts named = parts;
        for (size_t i = 0; i < std::size(HEAD_PARTS); ++i)
            if (!has(named, HEAD_PARTS[i]) && named[i + 1] == HeadPart::none) parts[i + 1] = HEAD_PARTS[i];
    }
    const Parts own = parts;
    for (int number = 1; number < 256; ++number) {
        int steps = 0;  // limits the loop: a damaged tree of groups may have cycles
        for (uint8_t above = group(uint8_t(number)).parent;
             parts[size_t(number)] == HeadPart::none && above != 0 && ++steps < 256; above = group(above).parent)
            parts[size_t(number)] = own[above];
    }
    return sections;
}

}  // namespace shvr
