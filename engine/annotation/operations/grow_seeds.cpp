// Grows groups from seeds by flooding a box in the order of costs.
//
// The order is the definition: the neighbours of all seed voxels are reached first, in the order of the seeds' places
// (x fastest); then, again and again, the neighbours of the voxel with the lowest cost among those reached but not yet
// visited, of equal costs the one reached first. A voxel gets the group of the voxel from which it is reached first;
// neighbours are those over faces, visited in the order -z, -y, -x, +x, +y, +z.

#include <cmath>
#include <limits>

#include "engine/annotation/operations/flood_queues.h"
#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/base/text.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {

namespace {

constexpr int64_t MAX_READ_BYTES = int64_t{64} << 20;

GroupSet seeds_of(const GrowSeedsOp& op, const GroupSet& locked)
{
    GroupSet seeds;
    if (op.groups.empty()) seeds.set();
    for (const uint8_t group : op.groups) seeds[group] = true;
    seeds[0] = false;
    if (op.groups.empty() && op.limits.inside) seeds[size_t(*op.limits.inside)] = false;
    return seeds & ~locked;
}

/// The voxels of a box, x fastest, and their costs.
class Costs {
public:
    Costs(const GrowSeedsOp& op, MaskEdit& edit, const VoxelBox& box);
    /// Bytes for each voxel of `values_`.
    static uint64_t bytes_of_voxel(const MaskEdit& edit) { return bytes_of(edit.source().info().type); }
    static VoxelBox box_of_values(const GrowSeedsOp& op, const VoxelBox& box, const Size3& size);
    void read(const Progress& progress);
    double value(const Size3& voxel) const
    {
        double value = 0.0;
        const auto at = size_t(index_of(voxel - box_.lower, extent_)) * bytes_of(type_);
        load_voxels(type_, values_.data() + at, {&value, 1});
        return value;
    }
    /// Never NaN: voxels that have no cost come last.
    double operator()(const Size3& voxel) const;
    /// Whether all costs are whole numbers below 65536.
    bool are_small() const { return on_ != GrowSeedsOp::On::gradient && bytes_of(type_) <= 2; }

private:
    double squared_gradient(const Size3& voxel) const;

    MaskEdit& edit_;
    GrowSeedsOp::On on_;
    VoxelType type_;
    VoxelBox box_;
    Size3 extent_;
    Size3 size_;
    glm::dvec3 spacing_;
    double least_ = 0.0;  ///< least value of the type, if it has one or two bytes
    std::vector<std::byte> values_;
};

/// Gradients also look at the neighbours of the box.
VoxelBox Costs::box_of_values(const GrowSeedsOp& op, const VoxelBox& box, const Size3& size)
{
    const VoxelBox around = op.on == GrowSeedsOp::On::gradient ? grown(box, 1) : box;
    return {glm::max(around.lower, Size3(0)), glm::min(around.upper, size)};
}

Costs::Costs(const GrowSeedsOp& op, MaskEdit& edit, const VoxelBox& box)
    : edit_(edit),
      on_(op.on),
      type_(edit.source().info().type),
      box_(box_of_values(op, box, edit.mask().size())),
      extent_(box_.size()),
      size_(edit.mask().size()),
      spacing_(edit.input().volume.spacing),
      least_(type_ == VoxelType::int8    ? -128.0
             : type_ == VoxelType::int16 ? -32768.0
                                         : 0.0),
      values_(size_t(extent_.x * extent_.y * extent_.z) * bytes_of(type_))
{}

void Costs::read(const Progress& progress)
{
    const VolumeSource& source = edit_.source();
    const int64_t bytes_of_slice = extent_.x * extent_.y * int64_t(bytes_of(type_)),
                  block = std::max<int64_t>(source.block().z, 1);
    const int64_t step = std::max<int64_t>(MAX_READ_BYTES / bytes_of_slice / block, 1) * block;
    for (int64_t z = box_.lower.z; z < box_.upper.z;) {
        const int64_t end = std::min((z / step + 1) * step, box_.upper.z);
        VoxelBox part = box_;
        part.lower.z = z;
        part.upper.z = end;
        source.read(part, std::span(values_).subspan(size_t((z - box_.lower.z) * bytes_of_slice),
                                                     size_t((end - z) * bytes_of_slice)));
        z = end;
        tell(progress, double(z - box_.lower.z) / double(extent_.z));
    }
    const Size3 bricks = (box_.upper - int64_t{1}) / BRICK_SIDE - box_.lower / BRICK_SIDE + int64_t{1};
    edit_.count_intensities(bricks.x * bricks.y * bricks.z);
}

/// By central differences, one-sided at the volume's border. Squares have the order of the magnitudes.
double Costs::squared_gradient(const Size3& voxel) const
{
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        Size3 before = voxel, after = voxel;
        before[axis] = std::max<int64_t>(before[axis] - 1, 0);
        after[axis] = std::min<int64_t>(after[axis] + 1, size_[axis] - 1);
        if (before == after) continue;
        const double slope = (value(after) - value(before)) / (double(after[axis] - before[axis]) * spacing_[axis]);
        sum += slope * slope;
    }
    return sum;
}

double Costs::operator()(const Size3& voxel) const
{
    const double cost = on_ == GrowSeedsOp::On::gradient ? squared_gradient(voxel)
                        : bytes_of(type_) > 2 ? (on_ == GrowSeedsOp::On::intensity ? value(voxel) : -value(voxel))
                        : on_ == GrowSeedsOp::On::intensity
                            ? value(voxel) - least_
                            : double(bytes_of(type_) == 1 ? 255 : 65535) - (value(voxel) - least_);
    return std::isnan(cost) ? std::numeric_limits<double>::infinity() : cost;
}

class Flood {
public:
    Flood(const GrowSeedsOp& op, MaskEdit& edit, const VoxelBox& box)
        : op_(op),
          edit_(edit),
          box_(box),
          extent_(box.size()),
          seeds_(seeds_of(op, edit.input().locked)),
          groups_(size_t(extent_.x * extent_.y * extent_.z)),
          is_open_(groups_.size()),
          costs_(op, edit, box)
    {}
    static void check_size(const GrowSeedsOp& op, const MaskEdit& edit, const VoxelBox& box);
    void grow(const Progress& progress);

private:
    template <class Visit>
    void for_each_brick_of_box(const Visit& visit);
    void prepare(int64_t brick);
    bool is_open(const Size3& voxel, uint8_t held) const;
    template <class Queue>
    void flood(Queue queue, const Progress& progress);
    template <class Queue>
    void reach_from(const Size3& at, uint32_t place, Queue& queue);
    void write(int64_t brick);
    uint32_t place_of(const Size3& voxel) const { return uint32_t(index_of(voxel - box_.lower, extent_)); }

    const GrowSeedsOp& op_;
    MaskEdit& edit_;
    VoxelBox box_;
    Size3 extent_;
    GroupSet seeds_;
    std::vector<uint8_t> groups_;  ///< of seeds, and of voxels that were reached; otherwise 0
    std::vector<bool> is_open_;    ///< whether the voxel can be reached, and was not
    Costs costs_;
    int64_t open_ = 0, reached_ = 0;
};

/// Fails if the box takes more memory than there is.
void Flood::check_size(const GrowSeedsOp& op, const MaskEdit& edit, const VoxelBox& box)
{
    const auto voxels_of = [](const VoxelBox& part) {
        const Size3 size = part.size();
        return uint64_t(size.x) * uint64_t(size.y) * uint64_t(size.z);
    };
    const Size3 size = box.size();
    const uint64_t voxels = voxels_of(box), value = Costs::bytes_of_voxel(edit);
    const bool has_buckets = op.on != GrowSeedsOp::On::gradient && value <= 2;
    const uint64_t queue = has_buckets ? BucketQueue::BYTES_OF_VOXEL : HeapQueue::BYTES_OF_VOXEL;
    // The box around the seeds has at most 2^60 voxels, so this may exceed 64 bits only in the product.
    const double bytes = double(voxels) * (1.25 + double(queue)) +
                         double(voxels_of(Costs::box_of_values(op, box, edit.mask().size()))) * double(value);
    const uint64_t memory = edit.input().memory;
    if (voxels < std::numeric_limits<uint32_t>::max() && (memory == 0 || bytes <= double(memory))) return;
    const auto mib = [](double each) { return int64_t(std::ceil(each / double(1 << 20))); };
    const std::string most = memory == 0 ? sentence("fewer than 2^32 voxels")
                                         : sentence("at most ", mib(double(memory)), " MiB, the budget of the host");
    fail("the box in which the groups grow is ", text_of(box), " (", size.x, " x ", size.y, " x ", size.z,
         " voxels), which takes ", mib(bytes), " MiB of memory; expected ", most,
         ": give a smaller box or margin, or a larger --budget-host");
}

template <class Visit>
void Flood::for_each_brick_of_box(const Visit& visit)
{
    const Size3 first = box_.lower / BRICK_SIDE, last = (box_.upper - int64_t{1}) / BRICK_SIDE;
    for (int64_t z = first.z; z <= last.z; ++z)
        for (int64_t y = first.y; y <= last.y; ++y)
            for (int64_t x = first.x; x <= last.x; ++x) visit(index_of(Size3(x, y, z), edit_.mask().brick_counts()));
}

bool Flood::is_open(const Size3& voxel, uint8_t held) const
{
    const OperationLimits& limits = op_.limits;
    if (!edit_.is_behind_plane(voxel) || seeds_[held] || edit_.input().locked[held] ||
        (limits.only_unpainted && held != 0) || (limits.inside && *limits.inside != held))
        return false;
    if (!limits.within) return true;
    const double value = costs_.value(voxel);
    return value >= limits.within->x && value <= limits.within->y;
}

void Flood::prepare(int64_t brick)
{
    const MaskBrick& held = edit_.read(brick);
    const VoxelBox own = edit_.mask().box_of(brick);
    const VoxelBox part{glm::max(own.lower, box_.lower), glm::min(own.upper, box_.upper)};
    for (int64_t z = part.lower.z; z < part.upper.z; ++z)
        for (int64_t y = part.lower.y; y < part.upper.y; ++y)
            for (int64_t x = part.lower.x; x < part.upper.x; ++x) {
                const Size3 voxel(x, y, z);
                const uint8_t group = held[index_in_brick(voxel)];
                const uint32_t place = place_of(voxel);
                if (seeds_[group] && edit_.is_behind_plane(voxel)) groups_[place] = group;
                if (!is_open(voxel, group)) continue;
                is_open_[place] = true;
                ++open_;
            }
}

template <class Queue>
void Flood::reach_from(const Size3& at, uint32_t place, Queue& queue)
{
    for (const int side : {-3, -2, -1, 1, 2, 3}) {
        const int axis = std::abs(side) - 1;
        Size3 next = at;
        next[axis] += side < 0 ? -1 : 1;
        if (next[axis] < box_.lower[axis] || next[axis] >= box_.upper[axis]) continue;
        const uint32_t there = place_of(next);
        if (!is_open_[there]) continue;
        is_open_[there] = false;
        groups_[there] = groups_[place];
        ++reached_;
        queue.push(there, costs_(next));
    }
}

template <class Queue>
void Flood::flood(Queue queue, const Progress& progress)
{
    constexpr int64_t STEP = 65536;
    std::vector<bool> is_seed(groups_.size());
    for (size_t place = 0; place < groups_.size(); ++place) is_seed[place] = groups_[place] != 0;
    for (size_t place = 0; place < groups_.size(); ++place)
        if (is_seed[place]) reach_from(box_.lower + position_of(int64_t(place), extent_), uint32_t(place), queue);
    int64_t visited = 0;
    while (!queue.is_empty()) {
        const uint32_t place = queue.pop();
        reach_from(box_.lower + position_of(place, extent_), place, queue);
        if (++visited % STEP == 0) tell(progress, double(visited) / double(open_));
    }
}

void Flood::write(int64_t brick)
{
    MaskBrick wanted = edit_.read(brick);
    const VoxelBox own = edit_.mask().box_of(brick);
    const VoxelBox part{glm::max(own.lower, box_.lower), glm::min(own.upper, box_.upper)};
    for (int64_t z = part.lower.z; z < part.upper.z; ++z)
        for (int64_t y = part.lower.y; y < part.upper.y; ++y)
            for (int64_t x = part.lower.x; x < part.upper.x; ++x) {
                const Size3 voxel(x, y, z);
                if (const uint8_t group = groups_[place_of(voxel)]; group != 0) wanted[index_in_brick(voxel)] = group;
            }
    edit_.want(brick, wanted);
}

void Flood::grow(const Progress& progress)
{
    costs_.read(part_of(progress, 0.0, 0.3));
    for_each_brick_of_box([&](int64_t brick) {
        tell(progress, 0.3);  // may end the operation
        prepare(brick);
    });
    const Progress flooding = part_of(progress, 0.35, 0.95);
    if (costs_.are_small())
        flood(BucketQueue(groups_.size()), flooding);
    else
        flood(HeapQueue(groups_.size()), flooding);
    for_each_brick_of_box([&](int64_t brick) {
        tell(progress, 0.95);
        write(brick);
    });
    const std::string left =
        reached_ < open_ ? sentence(", where no seed reaches ", counted(open_ - reached_, "voxel")) : std::string();
    edit_.note(sentence("grown in the box ", text_of(box_), left));
}

/// Box around all seed voxels that the limits' box and plane leave; empty if there are none.
std::optional<VoxelBox> box_of_seeds(const GroupSet& seeds, MaskEdit& edit, const Progress& progress)
{
    std::optional<VoxelBox> around;
    const std::optional<VoxelBox>& box = edit.limits().box;
    for_each_brick(edit.mask(), progress, [&](int64_t brick) {
        if (!edit.may_change(brick)) return;
        const MaskBrick& held = edit.read(brick);
        const VoxelBox own = edit.mask().box_of(brick);
        const VoxelBox part = box ? VoxelBox{glm::max(own.lower, box->lower), glm::min(own.upper, box->upper)} : own;
        for (int64_t z = part.lower.z; z < part.upper.z; ++z)
            for (int64_t y = part.lower.y; y < part.upper.y; ++y)
                for (int64_t x = part.lower.x; x < part.upper.x; ++x) {
                    const Size3 voxel(x, y, z);
                    if (!seeds[held[index_in_brick(voxel)]] || !edit.is_behind_plane(voxel)) continue;
                    const VoxelBox one{voxel, voxel + int64_t{1}};
                    around = around ? united(*around, one) : one;
                }
    });
    return around;
}

}  // namespace

void perform(const GrowSeedsOp& op, MaskEdit& edit, const Progress& progress)
{
    const std::optional<VoxelBox> seeds =
        box_of_seeds(seeds_of(op, edit.input().locked), edit, part_of(progress, 0.0, 0.05));
    if (!seeds)
        fail("no group", op.groups.empty() ? std::string() : " of " + text_of(op.groups),
             " that is not locked has voxels", op.limits.box ? " in the box " + text_of(*op.limits.box) : std::string(),
             op.limits.plane_normal ? " behind the plane" : "", "; expected some as seeds");
    VoxelBox box{Size3(0), edit.mask().size()};
    if (op.limits.box) box = {glm::max(box.lower, op.limits.box->lower), glm::min(box.upper, op.limits.box->upper)};
    if (op.margin || !op.limits.box) {
        const VoxelBox near = grown(*seeds, op.margin.value_or(GrowSeedsOp::MARGIN));
        box = {glm::max(box.lower, near.lower), glm::min(box.upper, near.upper)};
    }
    Flood::check_size(op, edit, box);
    Flood(op, edit, box).grow(part_of(progress, 0.05, 1.0));
}

}  // namespace shvr
