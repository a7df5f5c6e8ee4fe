#pragma once
// Parameters of cutting by a polygon that is drawn in a view.

#include <vector>

#include "engine/annotation/operations/operation_limits.h"

namespace shvr {

/// A view of the volume. A polygon lies in the plane across the line of sight, with x to the right and y upwards from
/// the line of sight: for an orthographic view in the unit of the volume's spacing, for a perspective one at distance 1
/// from the eye.
struct LassoView {
    /// From a face of the volume: orthographic, with `eye` at the lower left corner of the face as it is seen, so that
    /// polygons and depths count from there. Names and directions are those of the session's camera.
    enum class Face { none, front, back, left, right, top, bottom };
    enum class Projection { perspective, orthographic };
    Face face = Face::none;  ///< instead of the others
    Projection projection = Projection::orthographic;
    glm::dvec3 eye{0.0}, target{0.0, 0.0, 1.0}, up{0.0, 1.0, 0.0};  ///< in the unit of the volume's spacing
};
inline constexpr Spelling<LassoView::Face> LASSO_FACES[] = {
    {LassoView::Face::front, "front"}, {LassoView::Face::back, "back"}, {LassoView::Face::left, "left"},
    {LassoView::Face::right, "right"}, {LassoView::Face::top, "top"},   {LassoView::Face::bottom, "bottom"}};
constexpr std::span<const Spelling<LassoView::Face>> spellings_of(LassoView::Face)
{
    return LASSO_FACES;
}
inline constexpr Spelling<LassoView::Projection> LASSO_PROJECTIONS[] = {
    {LassoView::Projection::perspective, "perspective"}, {LassoView::Projection::orthographic, "orthographic"}};
constexpr std::span<const Spelling<LassoView::Projection>> spellings_of(LassoView::Projection)
{
    return LASSO_PROJECTIONS;
}

/// The view from a face of the volume, as one with an eye; another view as it is.
LassoView with_eye(const LassoView& view, const VolumeInfo& volume);

/// Directions of a view that has an eye, of unit length. `is_valid`: target and eye differ, and `up` is not along the
/// line of sight.
struct LassoAxes {
    glm::dvec3 right{0.0}, up{0.0}, forward{0.0};
    bool is_valid = false;
};
LassoAxes axes_of(const LassoView& view);

/// Gives a group the painted voxels whose centres a drawn polygon encloses in a view, or erases them: a point is inside
/// if a line from it to the right crosses the closed polygon an odd number of times. Of points on the polygon itself,
/// those on lower and left sides are inside.
struct LassoOp {
    enum class Side { inside, outside };
    int64_t to_group = 0;           ///< that the voxels get; 0: they are erased
    std::vector<uint8_t> groups{};  ///< only voxels of these groups; empty: of all
    LassoView view{};
    std::vector<glm::dvec2> polygon{};  ///< closed from the last point to the first
    Side side = Side::inside;
    /// Only voxels at these distances from the eye along the line of sight, both inclusive; null: at any.
    std::optional<glm::dvec2> depth{};
    OperationLimits limits{};
    static constexpr size_t MAX_POINTS = 10'000;
};
inline constexpr Spelling<LassoOp::Side> LASSO_PARTS[] = {{LassoOp::Side::inside, "inside"},
                                                          {LassoOp::Side::outside, "outside"}};
constexpr std::span<const Spelling<LassoOp::Side>> spellings_of(LassoOp::Side)
{
    return LASSO_PARTS;
}

/// Reads "[[x,y], ...]", at least three points.
std::vector<glm::dvec2> read_polygon(const JsonNode& node);
std::string text_of(const std::vector<glm::dvec2>& polygon);
/// Reads the name of a face, or {"projection":...,"eye":...,"target":...,"up":...}.
LassoView read_lasso_view(const JsonNode& node);
std::string text_of(const LassoView& view);

}  // namespace shvr
