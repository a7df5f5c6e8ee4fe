#pragma once
// The operations on whole groups: the parameters of each, and a table with one row for each. Scripts, actions, palette,
// log and documentation are derived from the table. README.md explains how to add an operation.

#include <array>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "engine/annotation/operations/grow_seeds_op.h"
#include "engine/annotation/operations/lasso_op.h"
#include "engine/annotation/operations/operation_limits.h"
#include "engine/volume/grid.h"

namespace shvr {

/// Set operations on two groups. Since a voxel has exactly one group, the two have no voxels in common, and `with`
/// loses all voxels that `group` gains.
struct CombineOp {
    enum class How { add, subtract, intersect, copy, move, swap };
    int64_t group = 1;
    int64_t with = 2;
    How how = How::add;
    OperationLimits limits{};
};
inline constexpr Spelling<CombineOp::How> COMBINATIONS[] = {
    {CombineOp::How::add, "add"},   {CombineOp::How::subtract, "subtract"}, {CombineOp::How::intersect, "intersect"},
    {CombineOp::How::copy, "copy"}, {CombineOp::How::move, "move"},         {CombineOp::How::swap, "swap"}};
constexpr std::span<const Spelling<CombineOp::How>> spellings_of(CombineOp::How)
{
    return COMBINATIONS;
}

/// Connected parts of a group: keeps some parts and erases the others, gives each part its own group, or does both.
struct IslandsOp {
    enum class Keep { all, largest, at_least, at };
    int64_t group = 1;
    Keep keep = Keep::all;
    std::optional<int64_t> voxels{};    ///< with `at_least`: a part with fewer voxels is erased; alternative to `mm3`
    std::optional<double> mm3{};        ///< the same as a volume
    std::optional<glm::dvec3> at{};     ///< with `at`: position in the part to keep, in voxels
    std::optional<int64_t> split_from;  ///< group of the largest part; the next parts get the next groups
    int64_t connectivity = 6;           ///< 6 or 26
    OperationLimits limits{};
};
inline constexpr Spelling<IslandsOp::Keep> ISLANDS_KEPT[] = {{IslandsOp::Keep::all, "all"},
                                                             {IslandsOp::Keep::largest, "largest"},
                                                             {IslandsOp::Keep::at_least, "at_least"},
                                                             {IslandsOp::Keep::at, "at"}};
constexpr std::span<const Spelling<IslandsOp::Keep>> spellings_of(IslandsOp::Keep)
{
    return ISLANDS_KEPT;
}

/// Fills voxels that the group encloses: no path over faces outside the group connects them to the volume's border.
struct FillHolesOp {
    int64_t group = 1;
    OperationLimits limits{};
};

/// Fills between painted slices, such as every tenth one: between two neighbouring slices with voxels of the group, the
/// shape is interpolated by signed distances. A slice in between gets each voxel that is in both shapes, and no voxel
/// that is in neither shape; so shapes that neither overlap nor touch are not joined.
struct FillBetweenOp {
    enum class Axis { x, y, z };
    int64_t group = 1;
    Axis axis = Axis::z;  ///< across the slices
    OperationLimits limits{};
};
inline constexpr Spelling<FillBetweenOp::Axis> SLICING_AXES[] = {
    {FillBetweenOp::Axis::x, "x"}, {FillBetweenOp::Axis::y, "y"}, {FillBetweenOp::Axis::z, "z"}};
constexpr std::span<const Spelling<FillBetweenOp::Axis>> spellings_of(FillBetweenOp::Axis)
{
    return SLICING_AXES;
}

/// Operations by distance, in the unit of the volume's spacing, measured exactly between centres of voxels; a voxel at
/// exactly the limit is included. Positions beyond the volume's border belong neither to the group nor to its outside.
struct GrowOp {  ///< gives the group all voxels within the distance
    int64_t group = 1;
    double distance = 0.0;
    OperationLimits limits{};
};
struct ShrinkOp {  ///< erases the group's voxels within the distance of a voxel that is not in the group
    int64_t group = 1;
    double distance = 0.0;
    OperationLimits limits{};
};
struct OpenOp {  ///< shrinks, then grows by the same distance
    int64_t group = 1;
    double distance = 0.0;
    OperationLimits limits{};
};
struct CloseOp {  ///< grows, then shrinks by the same distance
    int64_t group = 1;
    double distance = 0.0;
    OperationLimits limits{};
};
/// Replaces the group by a wall along its surface. `in`: the voxels that shrinking by `wall` would erase; `out`: those
/// that growing by `wall` would add; `both`: inside and outside, each with half of the thickness.
struct HollowOp {
    enum class Side { in, out, both };
    int64_t group = 1;
    double wall = 0.0;
    Side side = Side::in;
    OperationLimits limits{};
};
inline constexpr Spelling<HollowOp::Side> HOLLOW_SIDES[] = {
    {HollowOp::Side::in, "in"}, {HollowOp::Side::out, "out"}, {HollowOp::Side::both, "both"}};
constexpr std::span<const Spelling<HollowOp::Side>> spellings_of(HollowOp::Side)
{
    return HOLLOW_SIDES;
}

/// Smooths the borders of all groups together: a voxel gets the group with the greatest total weight within the
/// distance; unpainted counts as a group. In a tie, its own group wins, then the group with the lowest number.
struct SmoothOp {
    enum class Method {
        median,   ///< all voxels within the distance weigh the same
        gaussian  ///< standard deviation distance / 2, truncated at the distance along each axis
    };
    std::vector<uint8_t> groups{};  ///< voxels change only if their old or new group is one of these; empty: any voxel
    double distance = 0.0;          ///< in the unit of the volume's spacing
    Method method = Method::median;
    OperationLimits limits{};
};
inline constexpr Spelling<SmoothOp::Method> SMOOTHINGS[] = {{SmoothOp::Method::median, "median"},
                                                            {SmoothOp::Method::gaussian, "gaussian"}};
constexpr std::span<const Spelling<SmoothOp::Method>> spellings_of(SmoothOp::Method)
{
    return SMOOTHINGS;
}

/// Gives the group all voxels whose intensities lie between two values, both inclusive; NaN is never included.
struct ThresholdOp {
    int64_t group = 1;
    std::optional<double> from{};  ///< null: no lower bound
    std::optional<double> to{};    ///< null: no upper bound
    OperationLimits limits{};
    static constexpr bool READS_INTENSITIES = true, PAINTS_ONLY = true;
};

/// Gives the group all voxels whose centres lie in the ball of a node or in the cone of an internode
/// (trace_shapes.h).
struct MaskFromTraceOp {
    int64_t group = 1;
    std::vector<uint8_t> of{};  ///< only nodes and internodes of these groups; empty: the whole trace
    OperationLimits limits{};
    static constexpr bool READS_TRACE = true, PAINTS_ONLY = true;
};

/// Adds the centre lines of a group to the trace; radii are distances to the group's surface. Changes no voxel.
struct TraceFromMaskOp {
    int64_t group = 1;
    /// Removes a line with a loose end if its length plus the radius of this end is at most `spur` radii of its branch.
    double spur = 1.5;
    std::optional<double> tolerance{};  ///< largest error of positions and radii; null: longest side of a voxel
    static constexpr bool ADDS_TRACE = true;
};

/// An operation's texts, and a function that visits its parameters: `fields(f, op)`, f as in engine/session/fields.h.
struct OperationRow {
    const char* id = "";       ///< never changes: files refer to it
    const char* title = "";    ///< "Fill holes"
    const char* meaning = "";  ///< one sentence
    const char* alias = "";    ///< alternative name in scripts; `id` differs, as another action has this id
};
template <class KindOfRow, class VisitFields>
struct FullOperationRow : OperationRow {
    using Kind = KindOfRow;
    VisitFields fields;
};
template <class Kind, class VisitFields>
constexpr auto operation(const OperationRow& texts, VisitFields fields)
{
    return FullOperationRow<Kind, VisitFields>{texts, fields};
}

inline constexpr auto GROUP_FIELD = [](auto& f, int64_t& group) {
    f.whole("group", group, 1, 255, {.meaning = "the group", .is_required = true});
};

inline const NumberRange OPERATION_DISTANCE{1e-12, 1e12, "a number above 0, up to 1e12"};
inline constexpr auto DISTANCE_FIELDS = [](auto& f, auto& op) {
    GROUP_FIELD(f, op.group);
    f.number("distance", op.distance, OPERATION_DISTANCE,
             {.meaning = "in the unit of the volume's spacing, inclusive", .is_required = true});
};

inline constexpr auto OPERATIONS = std::tuple{
    operation<CombineOp>(
        {"combine", "Combine groups", "adds, subtracts, intersects, copies, moves or swaps the voxels of two groups"},
        [](auto& f, CombineOp& op) {
            GROUP_FIELD(f, op.group);
            f.whole("with", op.with, 1, 255, {.meaning = "the other group", .is_required = true});
            f.choice("how", op.how, {.meaning = "how they are combined", .is_required = true});
            f.check("with", op.with != op.group, "another group than group");
        }),
    operation<IslandsOp>(
        {"islands", "Islands", "keeps the largest, the large or one of a group's connected parts, or splits them"},
        [](auto& f, IslandsOp& op) {
            using Keep = IslandsOp::Keep;
            GROUP_FIELD(f, op.group);
            f.choice("keep", op.keep, {"the parts that stay; the others are erased"});
            f.any_whole("voxels", op.voxels, 1, int64_t{1} << 53, {"fewest voxels of a part that at_least keeps"});
            f.number("mm3", op.mm3, {0.0, 1e30}, {"smallest volume of a part that at_least keeps", "mm3"});
            f.vector("at", op.at, {-1e12, 1e12}, {"position in the part to keep", "voxels"});
            f.any_whole("split_from", op.split_from, 1, 255,
                        {"group of the largest part; the next ones get the groups after it"});
            f.whole("connectivity", op.connectivity, 6, 26, {"6 or 26"});
            f.check("connectivity", op.connectivity == 6 || op.connectivity == 26, "6 or 26");
            f.check("keep", op.keep != Keep::all || op.split_from.has_value(),
                    "largest, at_least or at, unless split_from is given");
            f.check("voxels",
                    (op.keep == Keep::at_least) == (op.voxels.has_value() != op.mm3.has_value()) &&
                        (op.keep == Keep::at_least || (!op.voxels && !op.mm3)),
                    "either voxels or mm3 with \"keep\":\"at_least\", and neither without");
            f.check("at", (op.keep == Keep::at) == op.at.has_value(), "a position with \"keep\":\"at\", and only then");
        }),
    operation<ThresholdOp>({"threshold", "Threshold", "gives a group all voxels of a range of intensities"},
                           [](auto& f, ThresholdOp& op) {
                               GROUP_FIELD(f, op.group);
                               f.number("from", op.from, any_number(), {"lowest intensity"});
                               f.number("to", op.to, any_number(), {"highest intensity"});
                               f.check("from", op.from || op.to, "a lowest intensity, a highest one, or both");
                               f.check("to", !op.from || !op.to || *op.from <= *op.to, "at least the lowest intensity");
                           }),
    operation<FillHolesOp>({"fill_holes", "Fill holes", "fills what a group encloses on all sides"},
                           [](auto& f, FillHolesOp& op) { GROUP_FIELD(f, op.group); }),
    operation<FillBetweenOp>(
        {"fill_between", "Fill between slices", "fills the gaps between painted slices of a group"},
        [](auto& f, FillBetweenOp& op) {
            GROUP_FIELD(f, op.group);
            f.choice("axis", op.axis, {"the axis across the slices"});
        }),
    operation<GrowOp>({"grow", "Grow", "gives a group all voxels within a distance of it"}, DISTANCE_FIELDS),
    operation<ShrinkOp>({"shrink", "Shrink", "erases what is within a distance of the outside of a group"},
                        DISTANCE_FIELDS),
    operation<OpenOp>({"open_group", "Open", "shrinks and grows a group again, which removes thin parts", "open"},
                      DISTANCE_FIELDS),
    operation<CloseOp>({"close", "Close", "grows and shrinks a group again, which closes gaps"}, DISTANCE_FIELDS),
    operation<HollowOp>({"hollow", "Hollow", "leaves only a wall of a group"},
                        [](auto& f, HollowOp& op) {
                            GROUP_FIELD(f, op.group);
                            f.number(
                                "wall", op.wall, OPERATION_DISTANCE,
                                {.meaning = "thickness, in the unit of the volume's spacing", .is_required = true});
                            f.choice("side", op.side, {"on which side of the group's surface the wall lies"});
                        }),
    operation<SmoothOp>(
        {"smooth", "Smooth", "smooths the borders of some groups or all groups"},
        [](auto& f, SmoothOp& op) {
            f.other(
                "groups", [&](const JsonNode& node) { op.groups = read_groups(node); },
                [&] { return op.groups.empty() ? std::nullopt : std::optional(text_of(op.groups)); },
                {"only voxels that leave or join one of these groups change, such as [1, 2]; default: all groups"});
            f.choice("method", op.method, {"the weights of the voxels within the distance"});
            f.number("distance", op.distance, OPERATION_DISTANCE,
                     {.meaning = "in the unit of the volume's spacing, inclusive", .is_required = true});
        }),
    operation<GrowSeedsOp>(
        {"grow_seeds", "Grow from seeds", "grows painted groups until they meet on edges or ridges of intensity"},
        [](auto& f, GrowSeedsOp& op) {
            f.other(
                "groups", [&](const JsonNode& node) { op.groups = read_groups(node); },
                [&] { return op.groups.empty() ? std::nullopt : std::optional(text_of(op.groups)); },
                {"the groups that grow, such as [1, 2]; default: all but the one named by inside"});
            f.choice("on", op.on, {"what comes first: small gradients, low intensities, or high ones (inverted)"});
            f.any_whole("margin", op.margin, 0, MAX_SIDE,
                        {.meaning = "how far beyond the box around the seeds, in voxels",
                         .standard = "16 without a box, otherwise the whole box"});
        }),
    operation<LassoOp>(
        {"lasso", "Cut by an outline", "erases what an outline drawn in a view encloses, or what it does not"},
        [](auto& f, LassoOp& op) {
            f.whole("group", op.to_group, 0, 255, {"the group that the voxels get; 0: they are erased"});
            f.other(
                "groups", [&](const JsonNode& node) { op.groups = read_groups(node); },
                [&] { return op.groups.empty() ? std::nullopt : std::optional(text_of(op.groups)); },
                {"only voxels of these groups, such as [1, 2]; default: of all groups"});
            f.choice("side", op.side, {"which side of the outline"});
            f.other(
                "polygon", [&](const JsonNode& node) { op.polygon = read_polygon(node); },
                [&] { return op.polygon.empty() ? std::nullopt : std::optional(text_of(op.polygon)); },
                {.meaning = "points of the outline, [[x,y], ...], to the right and upwards from the line of sight, in "
                            "the unit of the volume's spacing; perspective: at distance 1 from the eye",
                 .is_required = true});
            f.other(
                "camera", [&](const JsonNode& node) { op.view = read_lasso_view(node); },
                [&] { return std::optional(text_of(op.view)); },
                {.meaning = "a face of the volume, such as \"front\", whose lower left corner is the origin, or "
                            "projection, eye, target and up, in the unit of the volume's spacing",
                 .is_required = true});
            f.other(
                "depth", [&](const JsonNode& node) { op.depth = read_range(node); },
                [&] { return op.depth ? std::optional(text_of(*op.depth)) : std::nullopt; },
                {"only voxels at these distances along the line of sight: [near, far], inclusive"});
        }),
    operation<MaskFromTraceOp>(
        {"mask_from_trace", "Mask from trace", "gives a group all voxels in the trace's balls and cones"},
        [](auto& f, MaskFromTraceOp& op) {
            GROUP_FIELD(f, op.group);
            f.other(
                "of", [&](const JsonNode& node) { op.of = read_groups(node); },
                [&] { return op.of.empty() ? std::nullopt : std::optional(text_of(op.of)); },
                {"only nodes and internodes of these groups, such as [1, 2]; default: of all"});
        }),
    operation<TraceFromMaskOp>(
        {"trace_from_mask", "Trace from mask", "adds the centre lines of a group, with radii, to the trace"},
        [](auto& f, TraceFromMaskOp& op) {
            GROUP_FIELD(f, op.group);
            f.number("spur", op.spur, {0.0, 1e6}, {"how far a side line with a loose end must reach", "radii"});
            f.number("tolerance", op.tolerance, {0.0, 1e12},
                     {"how far nodes may be off the centre line, in the unit of the volume's spacing"});
        }),
};

/// One of the rows' Kinds.
using GroupOperation = decltype(std::apply(
    [](const auto&... rows) { return std::variant<typename std::remove_cvref_t<decltype(rows)>::Kind...>(); },
    OPERATIONS));

template <class Kind>
inline constexpr bool IS_GROUP_OPERATION = std::is_constructible_v<GroupOperation, Kind>;

inline constexpr auto OPERATION_ROWS =
    std::apply([](const auto&... rows) { return std::array{static_cast<const OperationRow&>(rows)...}; }, OPERATIONS);

inline const OperationRow& row_of(const GroupOperation& operation)
{
    return OPERATION_ROWS[operation.index()];
}

/// Visits the keys of an operation: the operation's own keys, then the keys of its limits, if any.
template <class Fields, class Kind>
void operation_fields(Fields& f, Kind& op)
{
    std::apply(
        [&](const auto&... rows) {
            const auto visit = [&]<class Row>(const Row& row) {
                if constexpr (std::is_same_v<typename Row::Kind, Kind>) row.fields(f, op);
            };
            (visit(rows), ...);
        },
        OPERATIONS);
    if constexpr (requires { op.limits; }) limit_fields(f, op.limits);
}

}  // namespace shvr
