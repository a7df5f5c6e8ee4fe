// Cuts by a polygon drawn in a view. A brick that the polygon does not cross in the view is inside or outside as a
// whole; others are divided into parts of 8^3 voxels, so only parts along the polygon are tested voxel by voxel, each
// against the sides near it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/base/text.h"

namespace shvr {

LassoAxes axes_of(const LassoView& view)
{
    constexpr double MIN_SINE = 1e-6;
    const glm::dvec3 sight = view.target - view.eye;
    const double distance = glm::length(sight), height = glm::length(view.up);
    if (!(distance > 0.0) || !(height > 0.0) || !std::isfinite(distance) || !std::isfinite(height)) return {};
    const glm::dvec3 forward = sight / distance, right = glm::cross(forward, view.up / height);
    const double sine = glm::length(right);
    if (!(sine >= MIN_SINE)) return {};
    return {right / sine, glm::cross(right / sine, forward), forward, true};
}

std::vector<glm::dvec2> read_polygon(const JsonNode& node)
{
    if (node.count() < 3 || node.count() > LassoOp::MAX_POINTS)
        node.refuse(sentence("an array of 3 to ", LassoOp::MAX_POINTS, " points, such as [[0,0],[9,0],[9,9]]"));
    std::vector<glm::dvec2> polygon;
    for (const JsonNode& point : node.elements()) {
        if (point.count() != 2) point.refuse("two numbers, [x, y]");
        const std::vector<JsonNode> numbers = point.elements();
        polygon.emplace_back(numbers[0].number({-1e12, 1e12}), numbers[1].number({-1e12, 1e12}));
    }
    return polygon;
}

std::string text_of(const std::vector<glm::dvec2>& polygon)
{
    std::string text;
    for (const glm::dvec2& point : polygon)
        text += sentence(text.empty() ? "[[" : ",[", digits_of(point.x), ',', digits_of(point.y), ']');
    return text + "]";
}

LassoView with_eye(const LassoView& view, const VolumeInfo& volume)
{
    using Face = LassoView::Face;
    if (view.face == Face::none) return view;
    const int axis = view.face == Face::left || view.face == Face::right   ? 0
                     : view.face == Face::front || view.face == Face::back ? 1
                                                                           : 2;
    const bool is_far = view.face == Face::back || view.face == Face::right || view.face == Face::top;
    LassoView seen{.eye = glm::dvec3(0.0), .target = glm::dvec3(0.0), .up = glm::dvec3(0.0)};
    seen.target[axis] = is_far ? -1.0 : 1.0;
    seen.up[axis == 2 ? 1 : 2] = 1.0;
    const LassoAxes axes = axes_of(seen);
    // Where right, up and forward begin.
    const glm::dvec3 ways = axes.right + axes.up + axes.forward, extent = glm::dvec3(volume.size) * volume.spacing;
    for (int each = 0; each < 3; ++each) seen.eye[each] = ways[each] < 0.0 ? extent[each] : 0.0;
    seen.target += seen.eye;
    return seen;
}

LassoView read_lasso_view(const JsonNode& node)
{
    const NumberRange places{-1e12, 1e12};
    if (!node.exists() || !(node.is_text() || node.is_object()))
        node.refuse(R"(a face, such as "front", or a view, {"eye":[x,y,z],"target":[x,y,z],"up":[x,y,z]})");
    LassoView view;
    if (node.is_text()) {
        view.face = node.choice<LassoView::Face>();
        return view;
    }
    node.allow({"projection", "eye", "target", "up"});
    view.projection = node["projection"].choice_or(view.projection);
    view.eye = node["eye"].vector(places);
    view.target = node["target"].vector(places);
    view.up = node["up"].vector(places);
    if (!axes_of(view).is_valid) node["up"].refuse("a direction across the line from eye to target");
    return view;
}

std::string text_of(const LassoView& view)
{
    if (view.face != LassoView::Face::none) return sentence('"', spelled(view.face), '"');
    const auto text = [](const glm::dvec3& each) {
        return sentence('[', digits_of(each.x), ',', digits_of(each.y), ',', digits_of(each.z), ']');
    };
    return sentence(R"({"projection":")", spelled(view.projection), R"(","eye":)", text(view.eye), R"(,"target":)",
                    text(view.target), R"(,"up":)", text(view.up), '}');
}

namespace {

struct Side {
    glm::dvec2 a, b;
};

/// Whether the line from the point to the right crosses the side.
bool crosses(const glm::dvec2& point, const Side& side)
{
    return (side.a.y > point.y) != (side.b.y > point.y) &&
           point.x < side.a.x + (point.y - side.a.y) * (side.b.x - side.a.x) / (side.b.y - side.a.y);
}

bool is_inside(const glm::dvec2& point, std::span<const Side> sides)
{
    bool inside = false;
    for (const Side& side : sides) inside ^= crosses(point, side);
    return inside;
}

struct Rectangle {
    glm::dvec2 lower{std::numeric_limits<double>::infinity()}, upper{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec2& point)
    {
        lower = glm::min(lower, point);
        upper = glm::max(upper, point);
    }
    bool meets(const Rectangle& other) const
    {
        return glm::all(glm::lessThanEqual(lower, other.upper)) && glm::all(glm::lessThanEqual(other.lower, upper));
    }
};

Rectangle around(const Side& side)
{
    Rectangle rectangle;
    rectangle.add(side.a);
    rectangle.add(side.b);
    return rectangle;
}

class Cutter {
public:
    Cutter(const LassoOp& op, MaskEdit& edit);
    void cut(int64_t brick);

private:
    /// What a brick is in the view.
    struct Seen {
        Rectangle place{};
        double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;  ///< along the line of sight
        bool is_in_front = true;  ///< all of it is in front of the eye, so that `place` encloses it
    };
    /// How the voxels of a brick are tested.
    struct Test {
        enum class Fate { none, all, each };
        Fate fate = Fate::each;
        bool depths = true;  ///< by their distances, too
        std::vector<Side> sides{};
        bool cuts_whole() const { return fate == Fate::all && !depths; }
    };
    glm::dvec3 in_view(const glm::dvec3& voxel) const
    {
        const glm::dvec3 way = voxel * spacing_ - view_.eye;
        return {glm::dot(way, axes_.right), glm::dot(way, axes_.up), glm::dot(way, axes_.forward)};
    }
    bool is_perspective() const { return view_.projection == LassoView::Projection::perspective; }
    bool is_at_depth(double depth) const { return depth >= nearest_ && depth <= farthest_; }
    bool is_cut(const glm::dvec3& voxel, const Test& test) const;
    Seen seen(const VoxelBox& box) const;
    Test test_for(const VoxelBox& box, std::span<const Side> sides) const;
    void cut_part(const VoxelBox& part, const Test& test, const Size3& corner, MaskBrick& wanted) const;

    const LassoOp& op_;
    MaskEdit& edit_;
    glm::dvec3 spacing_;
    LassoView view_;
    LassoAxes axes_;
    double nearest_, farthest_;
    std::array<uint8_t, 256> cut_to_{};  ///< by group: what a voxel of it becomes if it is cut
    std::vector<Side> sides_{};
};

Cutter::Cutter(const LassoOp& op, MaskEdit& edit)
    : op_(op),
      edit_(edit),
      spacing_(edit.input().volume.spacing),
      view_(with_eye(op.view, edit.input().volume)),
      axes_(axes_of(view_)),
      nearest_(op.depth ? op.depth->x : -std::numeric_limits<double>::infinity()),
      farthest_(op.depth ? op.depth->y : std::numeric_limits<double>::infinity())
{
    std::iota(cut_to_.begin(), cut_to_.end(), uint8_t{0});
    for (const uint8_t group : op.groups) cut_to_[group] = uint8_t(op.to_group);
    if (op.groups.empty()) cut_to_.fill(uint8_t(op.to_group));
    cut_to_[0] = 0;
    for (size_t i = 0; i < op.polygon.size(); ++i)
        sides_.push_back({op.polygon[i], op.polygon[(i + 1) % op.polygon.size()]});
}

bool Cutter::is_cut(const glm::dvec3& voxel, const Test& test) const
{
    const glm::dvec3 at = in_view(voxel);
    if (test.depths && !is_at_depth(at.z)) return false;
    const bool cuts_inside = op_.side == LassoOp::Side::inside;
    if (test.fate == Test::Fate::all) return true;
    if (is_perspective() && !(at.z > 0.0)) return !cuts_inside;
    return is_inside(is_perspective() ? glm::dvec2(at) / at.z : glm::dvec2(at), test.sides) == cuts_inside;
}

/// The place of the box between the centres of its voxels, enlarged by more than the errors of rounding.
Cutter::Seen Cutter::seen(const VoxelBox& box) const
{
    constexpr double SPARE = 1e-9;
    Seen seen;
    double largest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::bvec3 far(corner & 1, corner & 2, corner & 4);
        const glm::dvec3 at = in_view(glm::mix(glm::dvec3(box.lower), glm::dvec3(box.upper), far));
        seen.nearest = std::min(seen.nearest, at.z);
        seen.farthest = std::max(seen.farthest, at.z);
        seen.place.add(is_perspective() ? glm::dvec2(at) / at.z : glm::dvec2(at));
        largest = std::max({largest, std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    }
    const double spare = SPARE * (largest + glm::length(view_.eye));
    seen.nearest -= spare;
    seen.farthest += spare;
    seen.is_in_front = !is_perspective() || seen.nearest > 0.0;
    const double in_place = is_perspective() ? spare / seen.nearest * (1.0 + largest / seen.nearest) : spare;
    seen.place.lower -= in_place;
    seen.place.upper += in_place;
    return seen;
}

/// How to test the voxels of a box; `sides` are those near a box that contains it, or all.
Cutter::Test Cutter::test_for(const VoxelBox& box, std::span<const Side> sides) const
{
    using Fate = Test::Fate;
    const Seen at = seen(box);
    const bool cuts_inside = op_.side == LassoOp::Side::inside;
    if (at.farthest < nearest_ || at.nearest > farthest_) return {Fate::none, false, {}};
    Test test{Fate::each, !(at.nearest >= nearest_ && at.farthest <= farthest_), {}};
    if (!at.is_in_front) {
        if (at.farthest <= 0.0) return {cuts_inside ? Fate::none : Fate::all, test.depths, {}};
        test.sides.assign(sides.begin(), sides.end());
        return test;
    }
    bool is_crossed = false;
    for (const Side& side : sides) {
        const Rectangle own = around(side);
        is_crossed = is_crossed || own.meets(at.place);
        const bool may_be_crossed = own.upper.x >= at.place.lower.x && own.lower.y <= at.place.upper.y &&
                                    own.upper.y >= at.place.lower.y;  // by a line to the right
        if (may_be_crossed) test.sides.push_back(side);
    }
    if (is_crossed) return test;
    const bool inside = is_inside(0.5 * (at.place.lower + at.place.upper), test.sides);
    test.fate = inside == cuts_inside ? Fate::all : Fate::none;
    return test;
}

void Cutter::cut_part(const VoxelBox& part, const Test& test, const Size3& corner, MaskBrick& wanted) const
{
    if (test.fate == Test::Fate::none) return;
    for (int64_t z = part.lower.z; z < part.upper.z; ++z)
        for (int64_t y = part.lower.y; y < part.upper.y; ++y)
            for (int64_t x = part.lower.x; x < part.upper.x; ++x) {
                const Size3 at(x, y, z);
                uint8_t& voxel = wanted[size_t(index_of(at - corner, Size3(BRICK_SIDE)))];
                const uint8_t cut = cut_to_[voxel];
                if (cut != voxel && (test.cuts_whole() || is_cut(glm::dvec3(at) + 0.5, test))) voxel = cut;
            }
}

void Cutter::cut(int64_t brick)
{
    constexpr int64_t PART = 8;
    if (!edit_.may_change(brick)) return;
    const VoxelBox box = edit_.mask().box_of(brick);
    const Test test = test_for(box, sides_);
    if (test.fate == Test::Fate::none) return;
    MaskBrick wanted = edit_.read(brick);
    if (test.cuts_whole()) {
        for (uint8_t& voxel : wanted) voxel = cut_to_[voxel];
    } else {
        for (int64_t z = box.lower.z; z < box.upper.z; z += PART)
            for (int64_t y = box.lower.y; y < box.upper.y; y += PART)
                for (int64_t x = box.lower.x; x < box.upper.x; x += PART) {
                    const Size3 lower(x, y, z);
                    const VoxelBox part{lower, glm::min(lower + PART, box.upper)};
                    cut_part(part, test_for(part, test.sides), box.lower, wanted);
                }
    }
    edit_.want(brick, wanted);
}

}  // namespace

void perform(const LassoOp& op, MaskEdit& edit, const Progress& progress)
{
    SHVR_CHECK(op.polygon.size() >= 3 && axes_of(with_eye(op.view, edit.input().volume)).is_valid);
    Cutter cutter(op, edit);
    for_each_brick(edit.mask(), progress, [&](int64_t brick) { cutter.cut(brick); });
}

}  // namespace shvr
