#include "engine/workbench/sight/words.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/base/text.h"
#include "engine/look/camera_motion.h"
#include "engine/session/words/number_words.h"
#include "engine/volume/unit.h"

namespace shvr::ui {

namespace {

std::string three(const glm::dvec3& values)
{
    return number_in_words(values.x) + ", " + number_in_words(values.y) + ", " + number_in_words(values.z);
}

/// Units of length, each a thousand times as long as the previous one.
constexpr const char* THOUSANDS[] = {"nm", "um", "mm", "m"};

/// Formats a length in the unit for which its number has the fewest zeros.
std::string readable(double length, std::string unit)
{
    auto at = std::ranges::find(THOUSANDS, unit);
    if (at != std::end(THOUSANDS)) {
        while (length >= 1000.0 && at + 1 != std::end(THOUSANDS)) length /= 1000.0, ++at;
        while (length < 1.0 && length > 0.0 && at != std::begin(THOUSANDS)) length *= 1000.0, --at;
        unit = *at;
    }
    if (unit == "voxel" && length != 1.0) unit = "voxels";
    return number_in_words(length) + " " + unit_in_words(unit);
}

}  // namespace

std::string length_in_words(double length, const std::string& unit)
{
    const std::string text = number_in_words(length);
    return text + " " + (unit == "voxel" && text != "1" ? "voxels" : unit_in_words(unit));
}

std::string value_in_words(const Measurement& measurement, const VolumeInfo& volume)
{
    if (measurement.kind != MeasureKind::angle)
        return length_in_words(length_of(measurement, volume.spacing), volume.unit);
    const std::optional<double> angle = angle_of(measurement, volume.spacing);
    if (!angle) return "no angle";
    char text[32];
    std::snprintf(text, sizeof text, "%.1f\u00b0", *angle);
    return text;
}

std::string place_in_words(const glm::dvec3& voxel, const VolumeInfo& volume)
{
    const glm::dvec3 whole = glm::floor(voxel);
    char text[96];
    std::snprintf(text, sizeof text, "voxel %.0f, %.0f, %.0f", whole.x, whole.y, whole.z);
    if (volume.unit == "voxel") return text;
    return sentence(text, " (", three(voxel * volume.spacing), " ", unit_in_words(volume.unit), ")");
}

std::string value_in_words(const Reading& reading)
{
    if (!reading.is_inside) return "outside";
    std::string text = reading.intensity ? "value " + number_in_words(*reading.intensity) : std::string("value ...");
    if (reading.offset != 0.0)
        text += std::string(reading.offset > 0.0 ? " + " : " - ") + number_in_words(std::abs(reading.offset));
    return text;
}

std::string in_words(const Reading& reading, const VolumeInfo& volume, const std::string& group_name)
{
    std::string text = place_in_words(reading.voxel, volume) + ": " + value_in_words(reading);
    if (!reading.is_inside || reading.group == 0) return text;
    const std::string group = sentence("group ", int(reading.group));  // an unnamed group is called this, too
    return text + ", " + (group_name == group ? group : group + " " + group_name);
}

std::string slice_in_words(int axis, const glm::dvec3& voxel, const VolumeInfo& volume)
{
    const double last = double(volume.size[axis]) - 1.0;
    const double slice = std::clamp(std::floor(voxel[axis]), 0.0, std::max(last, 0.0));
    const double at = (slice + 0.5) * volume.spacing[axis];
    std::string text = sentence("xyz"[axis], " ", int64_t(slice), " (0 to ", int64_t(last), ")");
    if (volume.unit != "voxel") text += ", " + length_in_words(at, volume.unit);
    return text;
}

double depth_below_surface(const Camera& camera, const CutBox& cut, const VolumeInfo& volume, const glm::dvec3& point)
{
    const glm::dvec3 lower = cut.lower * volume.spacing;
    const glm::dvec3 upper = glm::min(cut.upper, glm::dvec3(volume.size)) * volume.spacing;
    const glm::dvec3 forward = axes_of(camera).forward;
    // In perspective, the line of sight starts at the eye; otherwise it is parallel to the view's axis.
    const glm::dvec3 from = camera.projection == Camera::Projection::perspective
                                ? camera.eye
                                : point - forward * glm::dot(point - camera.eye, forward);
    const glm::dvec3 way = point - from;
    const double length = glm::length(way);
    if (!(length > 0.0)) return 0.0;
    double begin = camera.near_distance / std::max(glm::dot(way / length, forward), 1e-9);
    for (int axis = 0; axis < 3; ++axis) {
        const double speed = way[axis] / length;
        if (speed != 0.0) begin = std::max(begin, ((speed > 0.0 ? lower : upper)[axis] - from[axis]) / speed);
    }
    const glm::dvec4 plane = plane_in_voxels(cut, volume.size, volume.spacing);
    const glm::dvec3 normal = glm::dvec3(plane) / volume.spacing;  // per physical unit
    const double rate = glm::dot(normal, way / length);
    if (rate < 0.0) begin = std::max(begin, -(glm::dot(normal, from) + plane.w) / rate);
    return std::max(length - begin, 0.0);
}

ScaleBar scale_bar(double units_per_pixel, double longest_pixels, const std::string& unit)
{
    if (!(units_per_pixel > 0.0) || !(longest_pixels > 0.0) || !std::isfinite(units_per_pixel)) return {};
    const double longest = units_per_pixel * longest_pixels, power = std::pow(10.0, std::floor(std::log10(longest)));
    double length = power;
    for (const double factor : {2.0, 5.0})
        if (factor * power <= longest * (1.0 + 1e-9)) length = factor * power;
    return {length / units_per_pixel, readable(length, unit)};
}

std::string shortened_name(const std::string& name)
{
    constexpr size_t MOST = 32;
    const auto begins = [](char c) { return (uint8_t(c) & 0xc0) != 0x80; };
    size_t characters = 0;
    for (size_t at = 0; at < name.size(); ++at)
        if (begins(name[at]) && ++characters > MOST) return name.substr(0, at) + "...";
    return name;
}

}  // namespace shvr::ui
