#pragma once
// Facts that the writers of SHVR state in comments of meshes: unit, space, place, names of groups
// (engine/formats/export, engine/annotation/trace/trace_mesh.h), and 3D Slicer's SPACE=LPS or SPACE=RAS. Other comments
// of other programs are ignored. One thread.

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace shvr {

class MeshStatements {
public:
    /// One line of a comment.
    void take(std::string_view comment);
    /// The header of a binary STL, in which our comments are joined and perhaps cut.
    void take_stl_header(std::string_view header);

    /// Null if no length is stated, also if the unit is none ("voxel").
    std::optional<double> metres() const;
    bool states_unit() const { return !unit_.empty(); }
    const std::string& positions() const { return positions_; }
    const std::string& frame() const { return frame_; }
    const std::optional<glm::dvec3>& origin() const { return origin_; }
    const std::optional<glm::dmat3>& directions() const { return directions_; }
    /// "group 3", unless a comment names it.
    std::string name_of_group(uint8_t group) const;
    /// Replaces "group_3", as OBJ files of SHVR have it, by the name that a comment gives to it.
    std::string name_of_obj_group(std::string_view name) const;
    std::optional<uint8_t> stl_group() const { return stl_group_; }

private:
    std::string unit_, positions_, frame_;
    std::optional<glm::dvec3> origin_;
    std::optional<glm::dmat3> directions_;
    std::array<std::string, 256> groups_{};
    std::optional<uint8_t> stl_group_;
};

}  // namespace shvr
