#include "engine/device/device_mask.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/bricks/painted_table.h"
#include "engine/device/device_volume.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

constexpr uint32_t MASK_BRICKS_IN_UPLOAD = 128;  // bricks per upload: 4 MiB of staging
constexpr uint64_t MASK_FEWEST_BRICKS = 8, MASK_SPARE_SHARE = 16;
constexpr uint64_t MASK_BRICK_BYTES = uint64_t{gpu::BRICK_SIZE} * gpu::BRICK_SIZE * gpu::BRICK_SIZE;

}  // namespace

uint64_t DeviceMask::bytes_for(uint64_t painted_bricks)
{
    // Includes the slot that is never used, partly filled rows of the atlas, and the hash table, 3 numbers per entry.
    constexpr uint64_t ROW = 16;
    const uint64_t bricks = painted_bricks + painted_bricks / MASK_SPARE_SHARE + MASK_FEWEST_BRICKS + ROW;
    return bricks * MASK_BRICK_BYTES + 4 * std::bit_ceil(2 * painted_bricks + 16) * gpu::MASK_ENTRY;
}

/// The atlas for this many bricks; null if no image of the device can hold them.
std::optional<ResourceDesc> DeviceMask::desc_for(uint64_t bricks) const
{
    const gpu::DeviceTraits& traits = memory_.device().traits();
    const uint32_t max_side = traits.limits.maxImageDimension3D;
    const uint64_t slots = std::max(bricks, MASK_FEWEST_BRICKS) + 1;  // one stays unused
    if (slots > max_atlas_slots(gpu::BRICK_SIZE, max_side)) return std::nullopt;
    const ResourceDesc desc =
        image_desc(Format::r8_uint, atlas_layout(slots, gpu::BRICK_SIZE, max_side, traits.is_cpu) * gpu::BRICK_SIZE);
    return memory_.can_create(desc) ? std::optional(desc) : std::nullopt;
}

/// Allocates slots for `bricks` bricks and a reserve. The reserve is half of `bricks` if the total takes at most half
/// of the free memory, otherwise a sixteenth. There is no reserve if the device's images cannot hold it.
void DeviceMask::grow(uint64_t bricks)
{
    atlas_.reset();
    const bool has_spare = (bricks + bricks / 2) * MASK_BRICK_BYTES <= memory_.device_bytes_left() / 2;
    std::optional<ResourceDesc> desc = has_spare ? desc_for(bricks + bricks / 2) : std::nullopt;
    if (!desc) desc = desc_for(bricks + bricks / MASK_SPARE_SHARE);
    if (!desc) desc = desc_for(bricks);
    if (!desc)
        throw gpu::MemoryError(sentence("what is painted takes ", bricks,
                                        " bricks of 32^3 voxels, and an image of this device holds fewer: it is kept "
                                        "and saved, but not drawn; expected less, or another device (--device)"));
    const glm::uvec3 slots = desc->texels / gpu::BRICK_SIZE;
    atlas_ = memory_.create("mask", *desc, gpu::Placement::device, "what is painted");
    free_slots_.clear();
    slots_.clear();
    // The slot at the origin is NO_SLOT and stays unused. Slots are taken from the end of the list.
    for (uint32_t z = slots.z; z-- > 0;)
        for (uint32_t y = slots.y; y-- > 0;)
            for (uint32_t x = slots.x; x-- > 0;)
                if (const uint32_t slot = gpu::pack_slot({x, y, z}); slot != gpu::NO_SLOT) free_slots_.push_back(slot);
}

uint32_t DeviceMask::slot_of(int64_t brick) const
{
    const auto found = slots_.find(brick);
    return found == slots_.end() ? gpu::NO_SLOT : found->second;
}

void DeviceMask::clear()
{
    in_flight_.clear();
    atlas_.reset();
    table_.reset();
    slots_.clear();
    free_slots_.clear();
    is_table_stale_ = true;
}

void DeviceMask::update(const Mask& mask, std::span<const int64_t> bricks)
{
    try {
        if (is_stale_)
            send(mask, mask.painted_bricks());
        else
            send(mask, bricks);
        is_stale_ = false;
    } catch (...) {
        is_stale_ = true;
        clear();
        throw;
    }
}

void DeviceMask::send(const Mask& mask, std::span<const int64_t> bricks)
{
    const bool all_moved = give_slots(mask, bricks);
    if (slots_.empty()) return clear();
    if (all_moved)
        send_bricks(mask, mask.painted_bricks());
    else
        send_bricks(mask, bricks);
    if (is_table_stale_) send_table(mask);
    is_table_stale_ = false;
}

/// Assigns slots to painted bricks that have none, and releases the slots of bricks that are no longer painted. Returns
/// true if the atlas had to grow, which moves all bricks to other slots.
bool DeviceMask::give_slots(const Mask& mask, std::span<const int64_t> bricks)
{
    std::vector<int64_t> added;
    for (const int64_t brick : bricks) {
        const auto known = slots_.find(brick);
        if (mask.brick(brick)) {
            if (known == slots_.end()) added.push_back(brick);
        } else if (known != slots_.end()) {
            free_slots_.push_back(known->second);
            slots_.erase(known);
            is_table_stale_ = true;
        }
    }
    const bool grows = added.size() > free_slots_.size();
    if (grows) {
        grow(slots_.size() + added.size());
        added = mask.painted_bricks();
    }
    is_table_stale_ |= !added.empty();
    for (const int64_t brick : added) {
        if (!slots_.try_emplace(brick, free_slots_.back()).second) continue;  // listed twice
        free_slots_.pop_back();
    }
    return grows;
}

void DeviceMask::send_bricks(const Mask& mask, std::span<const int64_t> bricks)
{
    std::vector<uint8_t> voxels;
    std::vector<ImageRegion> regions;
    const auto send = [&] {
        FrameGraph graph;
        static_cast<void>(graph.copy_to_image(graph.upload<uint8_t>("mask bricks", voxels),
                                              graph.import("mask", atlas_.import()), std::exchange(regions, {}),
                                              "upload mask bricks"));
        voxels.clear();
        submit(std::move(graph));
    };
    for (const int64_t number : bricks) {
        const std::shared_ptr<const MaskBrick> brick = mask.brick(number);
        if (!brick) continue;
        regions.push_back({voxels.size(), gpu::mask_slot_origin(slots_.at(number)), glm::uvec3(gpu::BRICK_SIZE)});
        voxels.insert(voxels.end(), brick->begin(), brick->end());
        if (regions.size() == MASK_BRICKS_IN_UPLOAD) send();
    }
    if (!regions.empty()) send();
}

void DeviceMask::send_table(const Mask& mask)
{
    const std::vector<uint32_t> entries = hashed_ ? hashed_table(mask) : dense_table(mask);
    const glm::uvec3 counts(mask.brick_counts());
    const ResourceDesc desc =
        hashed_ ? buffer_desc(entries.size() * sizeof(uint32_t)) : image_desc(Format::r32_uint, counts);
    if (!table_ || table_.desc() != desc) {
        table_.reset();
        table_ = memory_.create("mask table", desc, gpu::Placement::device, "what is painted");
    }
    FrameGraph graph;
    const Resource from = graph.upload<uint32_t>("mask table entries", entries);
    const Resource to = graph.import("mask table", table_.import());
    static_cast<void>(hashed_ ? graph.copy(from, to, {{0, 0, desc.bytes}}, "upload mask table")
                              : graph.copy_to_image(from, to, {{0, glm::uvec3(0), counts}}, "upload mask table"));
    submit(std::move(graph));
}

std::vector<uint32_t> DeviceMask::dense_table(const Mask& mask) const
{
    const glm::i64vec3 counts = mask.brick_counts();
    std::vector<uint32_t> entries(size_t(counts.x * counts.y * counts.z));
    for (const auto& [brick, slot] : slots_) entries[size_t(brick)] = slot;
    return entries;
}

std::vector<uint32_t> DeviceMask::hashed_table(const Mask& mask) const
{
    const glm::i64vec3 counts = mask.brick_counts();
    std::vector<PaintedBrick> painted;
    for (const auto& [brick, slot] : slots_) painted.push_back({glm::uvec3(position_of(brick, counts)), slot});
    return painted_table(painted);
}

void DeviceMask::submit(FrameGraph graph)
{
    constexpr size_t MAX_IN_FLIGHT = 4;  // each submission holds an upload
    if (in_flight_.size() >= MAX_IN_FLIGHT) in_flight_.front().wait();
    std::erase_if(in_flight_, [](const gpu::Submission& submission) { return submission.done(); });
    in_flight_.push_back(executor_.submit(std::move(graph), {.timestamps = false}));
}

std::vector<VoxelBox> DeviceMask::bricks(const Size3& size) const
{
    const glm::i64vec3 counts(brick_counts(size));
    std::vector<VoxelBox> boxes;
    for (const auto& [index, slot] : slots_) boxes.push_back(voxels_of({0, position_of(index, counts)}, size));
    return boxes;
}

std::optional<MaskBinding> DeviceMask::import(FrameGraph& graph) const
{
    if (empty()) return std::nullopt;
    return MaskBinding{.mask = graph.import("mask", atlas_.import()),
                       .mask_table = graph.import("mask table", table_.import())};
}

}  // namespace shvr
