#include "engine/study/scene.h"

#include <algorithm>
#include <bit>

#include "engine/annotation/files/mask_source.h"
#include "engine/base/error.h"
#include "engine/live/relevance_host.h"
#include "engine/study/hand.h"
#include "engine/volume/grid.h"
#include "engine/volume/phantoms/phantom.h"

namespace shvr {

namespace {

/// Voxels in memory.
class HeldVolume final : public VolumeSource {
public:
    HeldVolume(const VolumeInfo& info, const std::vector<uint8_t>& voxels) : VolumeSource(info), voxels_(voxels) {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const Size3 size = box.size();
        for (int64_t z = 0; z < size.z; ++z)
            for (int64_t y = 0; y < size.y; ++y) {
                const auto row = voxels_.begin() + index_of(box.lower + Size3(0, y, z), info().size);
                std::copy_n(std::as_bytes(std::span(row, size_t(size.x))).begin(), size_t(size.x),
                            voxels.begin() + size.x * (y + size.y * z));
            }
    }

private:
    const std::vector<uint8_t>& voxels_;
};

std::vector<uint8_t> voxels_of(const VolumeSource& source)
{
    const Size3 size = source.info().size;
    std::vector<uint8_t> voxels(size_t(size.x * size.y * size.z));
    source.read({Size3(0), size}, std::as_writable_bytes(std::span(voxels)));
    return voxels;
}

Mask mask_of(const VolumeSource& groups)
{
    Mask mask(groups.info().size);
    for (const MaskBrickChange& change : mask_changes(groups, groups.info().name))
        mask.apply(change, Direction::forwards);
    return mask;
}

/// Keeps only the voxels (bits of `words`) that are connected to `seed` through faces within the region.
class HostFlood {
public:
    HostFlood(const BrushRegion& region, std::vector<uint32_t>& words) : size_(region.box.size()), words_(words)
    {
        per_row_ = region.words_per_row();
    }
    void keep_connected(const Size3& seed)
    {
        std::vector<uint32_t> kept(words_.size(), 0u);
        std::vector<Size3> waiting;
        const auto visit = [&](const Size3& at) {
            if (glm::any(glm::lessThan(at, Size3(0))) || glm::any(glm::greaterThanEqual(at, size_))) return;
            const auto word = size_t(at.x / 32 + per_row_ * (at.y + size_.y * at.z));
            const uint32_t bit = 1u << (at.x % 32);
            if ((words_[word] & bit) == 0 || (kept[word] & bit) != 0) return;
            kept[word] |= bit;
            waiting.push_back(at);
        };
        for (visit(seed); !waiting.empty();) {
            const Size3 at = waiting.back();
            waiting.pop_back();
            for (int axis = 0; axis < 3; ++axis) {
                Size3 step(0);
                step[axis] = 1;
                visit(at + step);
                visit(at - step);
            }
        }
        words_ = std::move(kept);
    }

private:
    Size3 size_;
    std::vector<uint32_t>& words_;
    int64_t per_row_ = 0;
};

}  // namespace

TraceGraph trace_of(const Phantom& phantom, const glm::dvec3& spacing)
{
    TraceGraph trace;
    for (size_t i = 0; i < phantom.nodes.size(); ++i) {
        const auto& [voxel, radius, group] = phantom.nodes[i];
        trace.apply(TraceNodeChange{uint32_t(i), {}, TraceNode{voxel * spacing, radius * spacing.x, group}},
                    Direction::forwards);
    }
    for (size_t i = 0; i < phantom.links.size(); ++i) {
        const auto& [from, to] = phantom.links[i];
        const TraceInternode internode{uint32_t(from), uint32_t(to), phantom.nodes[to].group};
        trace.apply(TraceInternodeChange{uint32_t(i), {}, internode}, Direction::forwards);
    }
    return trace;
}

StudyScene::StudyScene(const SceneSpec& spec) : spec_(spec), full_(Size3(spec.side)), partial_(Size3(spec.side))
{
    const Phantom phantom =
        make_phantom({.kind = "section", .size = Size3(spec.side), .seed = spec.seed, .flaws = {.noise = spec.noise}});
    voxels_ = voxels_of(*phantom.volume);
    volume_ = std::make_unique<HeldVolume>(phantom.volume->info(), voxels_);
    full_ = mask_of(*phantom.mask);
    partial_ = mask_of(*phantom.partial_mask);
    trace_ = trace_of(phantom, glm::dvec3(1.0));
    segments_ = segments_of(trace_);
    for (const auto& node : phantom.nodes) vein_radius_ += node.radius_voxels / double(phantom.nodes.size());
    note_bits();
    note_separate_bundles();
}

double StudyScene::voxels_per_metre() const
{
    return double(spec_.side) / STUDY_REACH_M;
}

void StudyScene::note_bits()
{
    const Size3 size = this->size();
    words_per_row_ = (size.x + 31) / 32 + 1;  // an extra word of zeros, since reads may extend into the next word
    bits_.assign(size_t(words_per_row_ * size.y * size.z), 0u);
    half_size_ = glm::ivec3((size + int64_t{1}) / int64_t{2});
    std::vector<uint8_t> visible(size_t(half_size_.x) * size_t(half_size_.y) * size_t(half_size_.z));
    size_t at = 0;
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) {
                if (double(voxels_[at++]) < STUDY_THRESHOLD) continue;
                bits_[size_t(x / 32 + words_per_row_ * (y + size.y * z))] |= 1u << (x % 32);
                ++visible[size_t(x / 2 + half_size_.x * (y / 2 + half_size_.y * (z / 2)))];
            }
    surface_.resize(visible.size());
    for (size_t i = 0; i < visible.size(); ++i) surface_[i] = visible[i] >= 4;
}

/// Finds the pieces of the full mask outside the partial mask, and the centres of their slices along the longest axis.
void StudyScene::note_separate_bundles()
{
    const Size3 size = this->size();
    std::vector<uint8_t> left(voxels_.size());
    for (size_t i = 0; i < left.size(); ++i) {
        const Size3 voxel = position_of(int64_t(i), size);
        left[i] = full_.at(voxel) != 0 && partial_.at(voxel) == 0;
    }
    for (size_t i = 0; i < left.size(); ++i) {
        if (!left[i]) continue;
        std::vector<Size3> piece{position_of(int64_t(i), size)};
        left[i] = 0;
        for (size_t next = 0; next < piece.size(); ++next)
            for (int neighbour = 0; neighbour < 27; ++neighbour) {
                const Size3 at = piece[next] + Size3(neighbour % 3, neighbour / 3 % 3, neighbour / 9) - int64_t{1};
                if (glm::any(glm::lessThan(at, Size3(0))) || glm::any(glm::greaterThanEqual(at, size))) continue;
                uint8_t& there = left[size_t(index_of(at, size))];
                if (there) piece.push_back(at);
                there = 0;
            }
        Size3 lower = piece[0], upper = piece[0];
        for (const Size3& at : piece) lower = glm::min(lower, at), upper = glm::max(upper, at);
        const Size3 sides = upper - lower;
        const int axis = sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
        if (double(sides[axis]) < 8.0 * vein_radius_) continue;  // voxels on the surfaces of other bundles
        const int64_t step = std::max<int64_t>(spec_.side / 24, 1);
        std::vector<glm::dvec4> sums(size_t(sides[axis] / step + 1), glm::dvec4(0.0));
        for (const Size3& at : piece)
            sums[size_t((at[axis] - lower[axis]) / step)] += glm::dvec4(glm::dvec3(at) + 0.5, 1.0);
        SeparateBundle bundle;
        for (const glm::dvec4& sum : sums)
            if (sum.w > 0.0) bundle.course.push_back(glm::dvec3(sum) / sum.w);
        separate_.push_back(std::move(bundle));
    }
}

void StudyScene::put_relevance(const RegionWish& wish, RelevancePatch& patch) const
{
    const RelevancePlace place = relevance_place(*volume_, wish);
    const Size3 size = place.box.size(), lower = place.box.lower;
    patch.origin = glm::ivec3(lower);
    patch.size = glm::ivec3(size);
    patch.words_per_row = int32_t((size.x + 31) / 32);
    patch.spacing = place.spacing;
    patch.volume_size = glm::ivec3(place.level_size);
    patch.level = place.level;
    const uint32_t last = size.x % 32 == 0 ? ~0u : (1u << (size.x % 32)) - 1u;
    size_t at = 0;
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y) {
            const auto row = size_t(words_per_row_ * (lower.y + y + this->size().y * (lower.z + z)));
            for (int32_t w = 0; w < patch.words_per_row; ++w) {
                const int64_t x = lower.x + 32 * w;
                const auto word = row + size_t(x / 32);
                const uint64_t two = bits_[word] | uint64_t(bits_[word + 1]) << 32;
                patch.words[at++] = uint32_t(two >> (x % 32)) & (w + 1 == patch.words_per_row ? last : ~0u);
            }
        }
}

bool StudyScene::shows_surface(const glm::ivec3& half_voxel) const
{
    if (glm::any(glm::lessThan(half_voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(half_voxel, half_size_)))
        return false;
    return surface_[size_t(half_voxel.x + half_size_.x * (half_voxel.y + half_size_.y * half_voxel.z))];
}

VoxelSelection StudyScene::select(const PaintOp& stroke) const
{
    SHVR_CHECK(stroke.brush != Brush::speckle && stroke.connectivity == 6, "a brush that the study does not use");
    VoxelSelection selection(size());
    for (const glm::dvec3& position : stroke_positions(stroke.path)) {
        const BrushRegion region =
            make_region(stroke.region, position, stroke.radius_voxels, volume_->info().spacing, size());
        const Size3 sides = region.box.size();
        std::vector<uint32_t> words(size_t(region.words_per_row() * sides.y * sides.z), 0u);
        for (int64_t row = 0; row < sides.y * sides.z; ++row) {
            const gpu::RowSpan& span = region.rows[size_t(row)];
            for (int64_t x = span.begin; x < int64_t(span.end); ++x)
                if (intensity(region.box.lower + Size3(x, row % sides.y, row / sides.y)) >= stroke.threshold)
                    words[size_t(row * region.words_per_row() + x / 32)] |= 1u << (x % 32);
        }
        if (stroke.brush == Brush::flood)
            HostFlood(region, words).keep_connected(Size3(glm::floor(position)) - region.box.lower);
        selection.add(region, words);
    }
    return selection;
}

}  // namespace shvr
