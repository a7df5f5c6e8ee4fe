#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/text.h"
#include "engine/formats/meshes/mesh_builder.h"
#include "engine/formats/meshes/mesh_forms.h"
#include "engine/formats/meshes/ply_header.h"

namespace shvr {
namespace {

using Rgb = std::array<uint8_t, 3>;

class PlyFile {
public:
    PlyFile(MeshInput& input, MeshMemory& memory)
        : input_(input), memory_(memory), header_(read_ply_header(input)), builder_(input.name(), memory)
    {}

    TriangleMesh read()
    {
        vertex_ = header_.find("vertex");
        const PlyElement* const face = header_.find("face");
        if (face->count > MAX_MESH_TRIANGLES) refuse_triangles(input_.name(), face->count);
        builder_.expect_points(vertex_->count);
        builder_.expect_triangles(face->count);
        for (const PlyElement& element : header_.elements) {
            if (&element == vertex_) {
                read_vertices();
            } else if (&element == face) {
                read_faces(element);
            } else if (!element.properties.empty()) {
                for (uint64_t i = 0; i < element.count; ++i)
                    for (const PlyProperty& property : element.properties) pass(property);
            }
        }
        TriangleMesh mesh = builder_.finish();
        if (!colors_.empty())
            for (MeshPart& part : mesh.parts) part.color = color_of(mesh, part);
        add_statements(mesh, header_.statements);
        return mesh;
    }

private:
    double value(PlyType type)
    {
        if (!header_.order) return number_in(input_, input_.word());
        const std::endian order = *header_.order;
        switch (type) {
            case PlyType::int8: return input_.value<int8_t>();
            case PlyType::uint8: return input_.value<uint8_t>();
            case PlyType::int16: return input_.value<int16_t>(order);
            case PlyType::uint16: return input_.value<uint16_t>(order);
            case PlyType::int32: return input_.value<int32_t>(order);
            case PlyType::uint32: return input_.value<uint32_t>(order);
            case PlyType::float32: return input_.value<float>(order);
            case PlyType::float64: return input_.value<double>(order);
        }
        SHVR_CHECK(false, int(type));
        return 0.0;
    }

    uint64_t length_of(const PlyProperty& list)
    {
        const double length = value(*list.count_type);
        if (!(length >= 0.0 && length <= UINT32_MAX) || length != std::floor(length))
            fail(input_.name(), ": has a list of ", length, " values; expected a whole number of them");
        return uint64_t(length);
    }

    void pass(const PlyProperty& property)
    {
        const uint64_t values = property.count_type ? length_of(property) : 1;
        if (header_.order) return input_.skip(values * bytes_of(property.type));
        for (uint64_t i = 0; i < values; ++i) static_cast<void>(value(property.type));
    }

    static uint8_t byte_of(PlyType type, double value)
    {
        const double scale = is_float(type) ? 255.0 : bytes_of(type) == 2 ? 255.0 / 65535.0 : 1.0;
        return uint8_t(value * scale > 0.0 ? std::lround(std::min(value * scale, 255.0)) : 0);
    }

    void read_vertices()
    {
        constexpr std::string_view ROLES[] = {"x", "y", "z", "red", "green", "blue"};
        std::vector<size_t> roles;
        size_t channels = 0;
        for (const PlyProperty& property : vertex_->properties) {
            const bool is_used = !property.count_type && vertex_->find(property.name) == &property;
            size_t role = std::size(ROLES);
            if (is_used) role = size_t(std::ranges::find(ROLES, property.name) - std::begin(ROLES));
            channels += role >= 3 && role < std::size(ROLES) ? 1 : 0;
            roles.push_back(role);
        }
        if (channels == 3) memory_.make_room(colors_, vertex_->count);
        for (uint64_t number = 0; number < vertex_->count; ++number) {
            glm::dvec3 at{0.0};
            Rgb color{};
            for (size_t i = 0; i < roles.size(); ++i) {
                const PlyProperty& property = vertex_->properties[i];
                if (roles[i] == std::size(ROLES)) {
                    pass(property);
                } else if (roles[i] < 3) {
                    at[int(roles[i])] = value(property.type);
                } else {
                    color[roles[i] - 3] = byte_of(property.type, value(property.type));
                }
            }
            builder_.add_point(at, [&] { return sentence(input_.name(), ": vertex ", number + 1); });
            if (channels == 3) colors_.push_back(color);
        }
    }

    void read_corners(const PlyProperty& corners, uint64_t number)
    {
        const uint64_t count = length_of(corners);
        MeshFan fan(builder_);
        for (uint64_t i = 0; i < count; ++i) {
            const double index = value(corners.type);
            if (!(index >= 0.0 && index < double(vertex_->count)) || index != std::floor(index))
                fail(input_.name(), ": face ", number + 1, " has the corner ", index, "; expected one of the ",
                     vertex_->count, " vertices, counted from 0");
            fan.add(uint32_t(index));
        }
        if (count < 3)
            fail(input_.name(), ": face ", number + 1, " has ", counted(int64_t(count), "corner"),
                 "; expected 3 or more corners");
    }

    void read_faces(const PlyElement& face)
    {
        const PlyProperty* const corners = corners_of(face);
        const PlyProperty* group = face.find("group");
        if (group != nullptr && (group->count_type || group->type != PlyType::uint8)) group = nullptr;
        int last_group = -1;
        for (uint64_t number = 0; number < face.count; ++number) {
            const uint64_t begin = builder_.triangles();
            int found = last_group;
            for (const PlyProperty& property : face.properties) {
                if (&property == corners) {
                    read_corners(property, number);
                } else if (&property == group) {
                    found = group_in(number);
                } else {
                    pass(property);
                }
            }
            if (std::exchange(last_group, found) != found)
                builder_.begin_part(header_.statements.name_of_group(uint8_t(found)), std::nullopt, begin);
        }
    }

    int group_in(uint64_t number)
    {
        const double group = value(PlyType::uint8);
        if (!(group >= 0.0 && group <= 255.0))
            fail(input_.name(), ": face ", number + 1, " has the group ", group, "; expected 0 to 255");
        return int(group);
    }

    /// The colour that all points of a part have; null if they differ.
    std::optional<glm::vec3> color_of(const TriangleMesh& mesh, const MeshPart& part) const
    {
        const Rgb first = colors_[mesh.triangles[part.begin].x];
        for (uint32_t i = part.begin; i < part.end; ++i)
            for (int corner = 0; corner < 3; ++corner)
                if (colors_[mesh.triangles[i][corner]] != first) return std::nullopt;
        return glm::vec3(first[0], first[1], first[2]) / 255.0f;
    }

    MeshInput& input_;
    MeshMemory& memory_;
    PlyHeader header_;
    MeshBuilder builder_;
    const PlyElement* vertex_ = nullptr;
    std::vector<Rgb> colors_{};  ///< one for each vertex; empty if they have none
};

}  // namespace

TriangleMesh read_ply(MeshInput& input, MeshMemory& memory)
{
    return PlyFile(input, memory).read();
}

}  // namespace shvr
