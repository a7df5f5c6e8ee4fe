#include "engine/formats/headers/nifti_header.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace shvr {
namespace {

class Fields {
public:
    Fields(std::string_view head, bool big_endian) : head_(head), big_endian_(big_endian) {}

    template <class T>
    T at(size_t offset, size_t index = 0) const
    {
        char bytes[sizeof(T)];
        std::memcpy(bytes, head_.data() + offset + index * sizeof(T), sizeof(T));
        if (big_endian_) std::reverse(bytes, bytes + sizeof(T));
        T value;
        std::memcpy(&value, bytes, sizeof(T));
        return value;
    }
    template <class T>
    glm::dvec3 vector(size_t offset) const
    {
        return {double{at<T>(offset, 0)}, double{at<T>(offset, 1)}, double{at<T>(offset, 2)}};
    }

private:
    std::string_view head_;
    bool big_endian_;
};

/// Field offsets of one NIfTI version. The versions also differ in the fields' types, which are parameters of `parse`.
struct Places {
    size_t dim, datatype, pixdim, voxels_at, slope, intercept, units, qform_code, sform_code, quaternion, qform_origin,
        sform;
};
constexpr Places PLACES_1{40, 70, 76, 108, 112, 116, 123, 252, 254, 256, 268, 280};
constexpr Places PLACES_2{16, 12, 104, 168, 176, 184, 500, 344, 348, 352, 376, 400};

template <class Real, class Side, class Code, class Offset, class Units>
NiftiHeader parse(const Fields& fields, const Places& places)
{
    NiftiHeader header;
    for (size_t i = 0; i < 8; ++i) header.dim[i] = fields.at<Side>(places.dim, i);
    for (size_t i = 0; i < 8; ++i) header.pixdim[i] = double{fields.at<Real>(places.pixdim, i)};
    header.datatype = fields.at<int16_t>(places.datatype);
    header.voxels_at = double(fields.at<Offset>(places.voxels_at));
    header.slope = double{fields.at<Real>(places.slope)};
    header.intercept = double{fields.at<Real>(places.intercept)};
    header.units = fields.at<Units>(places.units);
    header.qform_code = fields.at<Code>(places.qform_code);
    header.sform_code = fields.at<Code>(places.sform_code);
    header.quaternion = fields.vector<Real>(places.quaternion);
    header.qform_origin = fields.vector<Real>(places.qform_origin);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            const double number = double{fields.at<Real>(places.sform, size_t(4 * row + column))};
            (column < 3 ? header.sform_steps[column][row] : header.sform_origin[row]) = number;
        }
    }
    return header;
}

/// Returns whether `head` is big-endian; null if it does not begin with `bytes` (348 or 540) in either byte order.
std::optional<bool> byte_order(std::string_view head, int32_t bytes)
{
    if (head.size() < size_t(bytes)) return {};
    for (const bool big_endian : {false, true}) {
        if (Fields(head, big_endian).at<int32_t>(0) == bytes) return big_endian;
    }
    return {};
}

std::optional<NiftiAxes> checked(const NiftiAxes& axes)
{
    for (int axis = 0; axis < 3; ++axis) {
        const double length = glm::length(axes.steps[axis]);
        if (!std::isfinite(length) || !(length > 0.0) || !std::isfinite(axes.origin[axis])) return {};
    }
    // Refuses axes that lie in one plane, which span no volume.
    const glm::dmat3 units(glm::normalize(axes.steps[0]), glm::normalize(axes.steps[1]), glm::normalize(axes.steps[2]));
    if (std::abs(glm::determinant(units)) < 1e-6) return {};
    return axes;
}

}  // namespace

std::optional<NiftiHeader> parse_nifti_header(std::string_view head)
{
    using namespace std::string_view_literals;
    if (const auto big = byte_order(head, NiftiHeader::BYTES_OF_1)) {
        const std::string_view magic = head.substr(344, 4);
        if (magic != "n+1\0"sv && magic != "ni1\0"sv) return {};
        NiftiHeader header = parse<float, int16_t, int16_t, float, uint8_t>(Fields(head, *big), PLACES_1);
        header.is_pair = magic[1] == 'i';
        header.big_endian = *big;
        return header;
    }
    if (const auto big = byte_order(head, NiftiHeader::BYTES_OF_2)) {
        const std::string_view magic = head.substr(4, 4);
        if (magic != "n+2\0"sv && magic != "ni2\0"sv) return {};
        NiftiHeader header = parse<double, int64_t, int32_t, int64_t, int32_t>(Fields(head, *big), PLACES_2);
        header.version = 2;
        header.is_pair = magic[1] == 'i';
        header.big_endian = *big;
        return header;
    }
    return {};
}

bool is_analyze_header(std::string_view head)
{
    return byte_order(head, NiftiHeader::BYTES_OF_1).has_value() && !parse_nifti_header(head);
}

std::optional<NiftiAxes> qform_axes(const NiftiHeader& header)
{
    if (header.qform_code <= 0) return {};
    const double b = header.quaternion.x;
    const double c = header.quaternion.y;
    const double d = header.quaternion.z;
    const double rest = 1.0 - (b * b + c * c + d * d);
    // Stored numbers are rounded, so for a rotation by 180 degrees the vector (b, c, d) may be slightly longer than 1.
    if (!(rest > -1e-3)) return {};
    const double a = std::sqrt(std::max(0.0, rest));
    const double scale = 1.0 / std::sqrt(a * a + b * b + c * c + d * d);
    const glm::dvec4 q = glm::dvec4(a, b, c, d) * scale;
    const auto [w, x, y, z] = std::array{q.x, q.y, q.z, q.w};
    NiftiAxes axes;
    axes.steps[0] = {w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)};
    axes.steps[1] = {2.0 * (x * y - w * z), w * w + y * y - x * x - z * z, 2.0 * (y * z + w * x)};
    axes.steps[2] = {2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w + z * z - x * x - y * y};
    axes.steps[2] *= header.pixdim[0] < 0.0 ? -1.0 : 1.0;  // "qfac"
    for (int axis = 0; axis < 3; ++axis) axes.steps[axis] *= std::abs(header.pixdim[size_t(axis) + 1]);
    axes.origin = header.qform_origin;
    return checked(axes);
}

std::optional<NiftiAxes> sform_axes(const NiftiHeader& header)
{
    if (header.sform_code <= 0) return {};
    return checked({header.sform_steps, header.sform_origin});
}

}  // namespace shvr
