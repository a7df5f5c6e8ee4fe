#include "engine/annotation/measures/measurement.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "engine/annotation/measures/measures.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

std::string in_capitals(MeasureKind kind)
{
    std::string text(spelled(kind));
    text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

std::string numbered(MeasureKind kind, size_t number)
{
    return in_capitals(kind) + ' ' + std::to_string(number);
}

/// Returns the points as "x y z; x y z".
std::string points_in_words(const Measurement& measurement, const TraceSpace& space, Positions positions)
{
    std::string text;
    for (const glm::dvec3& voxel : measurement.points) {
        const glm::dvec3 position = voxel * space.spacing;
        text += text.empty() ? "" : "; ";
        text += digits_of(positions == Positions::physical ? physical_of(space, position) : position);
    }
    return text;
}

}  // namespace

bool is_count_of(MeasureKind kind, size_t points)
{
    if (const std::optional<size_t> last = last_point_of(kind)) return points == *last;
    return points >= 2 && points <= MAX_MEASURED_POINTS;
}

std::optional<size_t> last_point_of(MeasureKind kind)
{
    if (kind == MeasureKind::path) return std::nullopt;
    return kind == MeasureKind::angle ? 3 : 2;
}

double length_of(const Measurement& measurement, const glm::dvec3& spacing)
{
    double length = 0.0;
    for (size_t i = 1; i < measurement.points.size(); ++i)
        length += glm::length((measurement.points[i] - measurement.points[i - 1]) * spacing);
    return length;
}

std::optional<double> angle_of(const Measurement& measurement, const glm::dvec3& spacing)
{
    const std::vector<glm::dvec3>& points = measurement.points;
    if (points.size() != 3) return std::nullopt;
    const glm::dvec3 a = (points[0] - points[1]) * spacing, b = (points[2] - points[1]) * spacing;
    if (!(glm::length(a) > 0.0) || !(glm::length(b) > 0.0)) return std::nullopt;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

std::string name_of(const Measurement& measurement, size_t number)
{
    return measurement.name.empty() ? numbered(measurement.kind, number) : measurement.name;
}

std::string unused_name(std::span<const Measurement> others, MeasureKind kind)
{
    size_t number = 1;
    const auto is_taken = [&] {
        for (size_t i = 0; i < others.size(); ++i)
            if (name_of(others[i], i + 1) == numbered(kind, number)) return true;
        return false;
    };
    while (is_taken()) ++number;
    return numbered(kind, number);
}

std::string measurements_table(std::span<const Measurement> measurements, const TraceSpace& space, Positions positions,
                               char separator)
{
    const auto cell = [&](std::string text) {
        std::ranges::replace_if(
            text, [](char c) { return static_cast<unsigned char>(c) < 32; }, ' ');
        return csv_field(text);
    };
    const char* const line_end = separator == ',' ? "\r\n" : "\n";
    std::string table;
    const auto row = [&](const std::vector<std::string>& cells) {
        for (size_t i = 0; i < cells.size(); ++i) table += (i == 0 ? "" : std::string(1, separator)) + cell(cells[i]);
        table += line_end;
    };
    row({"number", "name", "kind", "length_" + space.unit, "angle_degrees",
         "points_" + space.unit + (positions == Positions::physical ? "_physical" : "_from_corner")});
    for (size_t i = 0; i < measurements.size(); ++i) {
        const Measurement& each = measurements[i];
        const bool is_angle = each.kind == MeasureKind::angle;
        const std::optional<double> angle = is_angle ? angle_of(each, space.spacing) : std::nullopt;
        row({std::to_string(i + 1), name_of(each, i + 1), std::string(spelled(each.kind)),
             is_angle ? "" : digits_of(length_of(each, space.spacing)), angle ? digits_of(*angle) : "",
             points_in_words(each, space, positions)});
    }
    return table;
}

}  // namespace shvr
