#include "engine/formats/meshes/glb_tables.h"

#include <glm/gtc/quaternion.hpp>

#include "engine/base/error.h"

namespace shvr {
namespace {

constexpr int64_t UNSIGNED_BYTES = 5121, UNSIGNED_SHORTS = 5123, UNSIGNED_INTS = 5125, FLOATS = 5126;
constexpr int64_t MAX_OFFSET = UINT32_MAX;  // a .glb file states its size in 32 bits
constexpr int64_t MIN_STRIDE = 4, MAX_STRIDE = 252;

template <size_t N>
std::array<double, N> numbers_of(const JsonNode& node)
{
    std::array<double, N> numbers;
    const std::vector<JsonNode> elements = node.elements(N, N);
    for (size_t i = 0; i < N; ++i) numbers[i] = elements[i].number(any_number());
    return numbers;
}

}  // namespace

GlbTable::GlbTable(const JsonNode& root, const char* name)
    : name_(name), elements_(root[name].exists() ? root[name].elements() : std::vector<JsonNode>{})
{}

size_t GlbTable::number_in(const JsonNode& reference) const
{
    if (elements_.empty())
        reference.refuse_because(sentence("refers to ", name_, ", which the file lacks; expected some"));
    return size_t(reference.whole(0, int64_t(elements_.size()) - 1));
}

GlbAccessors::GlbAccessors(const JsonNode& root, const GlbBinary& binary)
    : accessors_(root, "accessors"), views_(root, "bufferViews"), buffers_(root, "buffers"), binary_(binary)
{}

GlbAccessor GlbAccessors::positions(const JsonNode& reference) const
{
    const JsonNode& accessor = accessors_.at(reference);
    if (!accessor["type"].is("VEC3")) accessor["type"].refuse("VEC3, for positions");
    static_cast<void>(accessor["componentType"].whole(FLOATS, FLOATS));
    return placed(reference, sizeof(float), 3);
}

GlbAccessor GlbAccessors::indices(const JsonNode& reference) const
{
    const JsonNode& accessor = accessors_.at(reference);
    if (!accessor["type"].is("SCALAR")) accessor["type"].refuse("SCALAR, for indices");
    const int64_t type = accessor["componentType"].whole(UNSIGNED_BYTES, UNSIGNED_INTS);
    if (type != UNSIGNED_BYTES && type != UNSIGNED_SHORTS && type != UNSIGNED_INTS)
        accessor["componentType"].refuse("5121, 5123 or 5125, for indices");
    return placed(reference, type == UNSIGNED_BYTES ? 1 : type == UNSIGNED_SHORTS ? 2 : 4, 1);
}

GlbAccessor GlbAccessors::placed(const JsonNode& reference, uint64_t component_bytes, uint64_t components) const
{
    const JsonNode& accessor = accessors_.at(reference);
    if (accessor["sparse"].exists()) accessor["sparse"].refuse("an accessor that is not sparse");
    const JsonNode& view = views_.at(accessor.required("bufferView", "the number of a buffer view"));
    const JsonNode& buffer = buffers_.at(view.required("buffer", "the number of a buffer"));
    if (buffer["uri"].exists()) buffer["uri"].refuse("none: export it as one .glb file that holds its buffer");
    if (&buffer != &buffers_[0]) view["buffer"].refuse("0, and that buffer in the file itself");
    const auto view_begin = uint64_t(view["byteOffset"].whole(0, 0, MAX_OFFSET));
    const auto view_bytes = uint64_t(view.required("byteLength", "a number of bytes").whole(1, MAX_OFFSET));
    if (view_begin + view_bytes > binary_.bytes)
        view["byteLength"].refuse_because(sentence("ends at byte ", view_begin + view_bytes,
                                                   " of the binary chunk; expected at most ", binary_.bytes));
    const uint64_t element_bytes = component_bytes * components;
    const auto begin = uint64_t(accessor["byteOffset"].whole(0, 0, MAX_OFFSET));
    const auto count = uint64_t(accessor.required("count", "a number of elements").whole(1, MAX_OFFSET));
    const auto stride = uint64_t(view["byteStride"].whole(int64_t(element_bytes), MIN_STRIDE, MAX_STRIDE));
    if (stride < element_bytes) view["byteStride"].refuse(sentence("at least ", element_bytes));
    const uint64_t end = begin + stride * (count - 1) + element_bytes;
    if (end > view_bytes)
        accessor["count"].refuse_because(
            sentence("is ", count, ", for which its buffer view needs ", end, " bytes; expected at most ", view_bytes));
    return {accessors_.number_in(reference), binary_.offset + view_begin + begin, stride, count, component_bytes};
}

glm::dmat4 transform_of(const JsonNode& node)
{
    if (const JsonNode matrix = node["matrix"]; matrix.exists()) {
        const std::array<double, 16> numbers = numbers_of<16>(matrix);
        glm::dmat4 transform;
        for (size_t i = 0; i < numbers.size(); ++i) transform[int(i / 4)][int(i % 4)] = numbers[i];
        if (numbers[3] != 0.0 || numbers[7] != 0.0 || numbers[11] != 0.0 || numbers[15] != 1.0)
            matrix.refuse("a matrix whose last row is 0 0 0 1");
        return transform;
    }
    const glm::dvec3 translation = node["translation"].vector(glm::dvec3(0.0), any_number());
    const glm::dvec3 scale = node["scale"].vector(glm::dvec3(1.0), any_number());
    glm::dmat3 turned(1.0);
    if (const JsonNode rotation = node["rotation"]; rotation.exists()) {
        const auto [x, y, z, w] = numbers_of<4>(rotation);
        const glm::dquat turn(w, x, y, z);
        const double length = glm::length(turn);
        if (!(length > 0.5 && length < 2.0)) rotation.refuse("a quaternion of length 1");
        turned = glm::mat3_cast(turn / length);
    }
    glm::dmat4 transform(1.0);
    for (int axis = 0; axis < 3; ++axis) transform[axis] = glm::dvec4(turned[axis] * scale[axis], 0.0);
    transform[3] = glm::dvec4(translation, 1.0);
    return transform;
}

}  // namespace shvr
