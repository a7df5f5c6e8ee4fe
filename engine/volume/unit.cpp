#include "engine/volume/unit.h"

#include <utility>

#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr std::pair<const char*, const char*> UNITS[] = {
    {"micron", "um"},      {"microns", "um"},     {"micrometer", "um"}, {"micrometers", "um"}, {"micrometre", "um"},
    {"micrometres", "um"}, {"\u00b5m", "um"},     {"\u03bcm", "um"},    {"\xb5m", "um"},  // Latin-1
    {"millimeter", "mm"},  {"millimeters", "mm"}, {"millimetre", "mm"}, {"millimetres", "mm"}, {"nanometer", "nm"},
    {"nanometers", "nm"},  {"nanometre", "nm"},   {"nanometres", "nm"}, {"centimeter", "cm"},  {"centimeters", "cm"},
    {"centimetre", "cm"},  {"centimetres", "cm"}, {"meter", "m"},       {"meters", "m"},       {"metre", "m"},
    {"metres", "m"},       {"inch", "inch"},      {"inches", "inch"},
};

}  // namespace

std::string plain_unit(std::string_view unit)
{
    const std::string_view bare = trimmed(unit);
    const std::string lower = lower_case(bare);
    for (const auto& [spelling, plain] : UNITS) {
        if (lower == spelling) return plain;
    }
    for (const char* plain : {"um", "mm", "nm", "cm"}) {
        if (lower == plain) return plain;
    }
    constexpr size_t MAX_UNIT_BYTES = 60;
    return printable(bare.substr(0, MAX_UNIT_BYTES));
}

std::string unit_in_words(const std::string& unit)
{
    return unit == "um" ? "\u00b5m" : unit;
}

std::string spacing_in_words(const glm::dvec3& spacing, const std::string& unit)
{
    return digits_of(spacing.x) + " x " + digits_of(spacing.y) + " x " + digits_of(spacing.z) +
           (unit.empty() ? "" : " " + unit_in_words(unit));
}

std::optional<double> micrometres_in(const std::string& unit)
{
    constexpr std::pair<const char*, double> LENGTHS[] = {{"um", 1.0}, {"nm", 1e-3}, {"mm", 1e3},      {"cm", 1e4},
                                                          {"m", 1e6},  {"pm", 1e-6}, {"inch", 25400.0}};
    for (const auto& [name, micrometres] : LENGTHS)
        if (unit == name) return micrometres;
    return std::nullopt;
}

}  // namespace shvr
