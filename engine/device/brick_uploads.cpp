#include "engine/device/brick_uploads.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace shvr {

BrickUploads::BrickUploads(gpu::Executor& executor, gpu::Memory& memory, uint64_t bricks, bool filtered)
    : executor_(executor),
      filtered_(filtered),
      unpacks_(!memory.traits().is_cpu),
      batch_(size_t(std::clamp<uint64_t>(bricks, 1, BATCH)))
{
    for (Staging& staging : staging_)
        staging.bytes =
            memory.create("brick staging", buffer_desc(batch_ * (BrickTexels::CODE_BYTES + BrickTexels::RANGE_BYTES)),
                          gpu::Placement::upload, "the transfer of the volume");
}

void BrickUploads::stage(const Target& target, const BrickTexels& texels)
{
    if (targets_.size() == batch_) flush();  // which failed when the last one came
    Staging& staging = staging_[filling_];
    if (staging.copy) static_cast<void>(staging.copy.finish());
    std::byte* bytes = staging.bytes.mapped().data();
    std::memcpy(bytes + targets_.size() * BrickTexels::CODE_BYTES, texels.codes.data(), BrickTexels::CODE_BYTES);
    std::memcpy(bytes + batch_ * BrickTexels::CODE_BYTES + targets_.size() * BrickTexels::RANGE_BYTES,
                texels.cell_ranges.data(), BrickTexels::RANGE_BYTES);
    targets_.push_back(target);
    if (targets_.size() == batch_) flush();
}

void BrickUploads::flush()
{
    if (targets_.empty()) return;
    FrameGraph graph;
    const Resource staged = graph.import("brick staging", staging_[filling_].bytes.import());
    if (unpacks_)
        add_kernels(graph, staged);
    else
        add_copies(graph, staged);
    staging_[filling_].copy = executor_.submit(std::move(graph), {.timestamps = false});
    filling_ = 1 - filling_;
    upload_count_ += targets_.size();
    targets_.clear();
}

namespace {

/// Groups of bricks that go to the same image.
template <class Image, class Add>
void for_each_image(const std::vector<BrickUploads::Target>& targets, const Image& image, const Add& add)
{
    std::vector<const gpu::Storage*> images;
    for (const BrickUploads::Target& target : targets)
        if (std::ranges::find(images, image(target)) == images.end()) images.push_back(image(target));
    for (const gpu::Storage* each : images) {
        std::vector<uint32_t> bricks;
        for (uint32_t i = 0; i < targets.size(); ++i)
            if (image(targets[i]) == each) bricks.push_back(i);
        add(*each, bricks);
    }
}

}  // namespace

void BrickUploads::add_copies(FrameGraph& graph, Resource staged) const
{
    const glm::uvec3 codes_per_texel(filtered_ ? 1 : 2, 1, 1);
    for_each_image(
        targets_, [](const Target& target) { return target.codes; },
        [&](const gpu::Storage& image, const std::vector<uint32_t>& bricks) {
            std::vector<ImageRegion> regions;
            for (const uint32_t brick : bricks)
                regions.push_back({brick * BrickTexels::CODE_BYTES, targets_[brick].texel / codes_per_texel,
                                   glm::uvec3(gpu::BRICK_TEXELS) / codes_per_texel});
            static_cast<void>(graph.copy_to_image(staged, graph.import("atlas", image.import()), std::move(regions),
                                                  "upload bricks"));
        });
    for_each_image(
        targets_, [](const Target& target) { return target.cells; },
        [&](const gpu::Storage& image, const std::vector<uint32_t>& bricks) {
            std::vector<ImageRegion> regions;
            for (const uint32_t brick : bricks)
                regions.push_back({batch_ * BrickTexels::CODE_BYTES + brick * BrickTexels::RANGE_BYTES,
                                   targets_[brick].cell, glm::uvec3(gpu::BRICK_CELLS)});
            static_cast<void>(graph.copy_to_image(staged, graph.import("cell ranges", image.import()),
                                                  std::move(regions), "upload cell ranges"));
        });
}

/// A dispatch for each image of codes that bricks go to.
void BrickUploads::add_kernels(FrameGraph& graph, Resource staged) const
{
    Resource cells = graph.import("cell ranges", targets_.front().cells->import());
    for_each_image(
        targets_, [](const Target& target) { return target.codes; },
        [&](const gpu::Storage& image, const std::vector<uint32_t>& bricks) {
            std::vector<gpu::BrickUnpackJob> jobs;
            for (const uint32_t brick : bricks)
                jobs.push_back(
                    {.texel = targets_[brick].texel,
                     .codes = uint32_t(brick * BrickTexels::CODE_BYTES / sizeof(uint32_t)),
                     .cell = targets_[brick].cell,
                     .ranges = uint32_t((batch_ * BrickTexels::CODE_BYTES + brick * BrickTexels::RANGE_BYTES) /
                                        sizeof(uint32_t))});
            cells = brick_unpack(graph, staged, graph.import("atlas", image.import()), cells, filtered_, jobs);
        });
}

void BrickUploads::finish()
{
    for (Staging& staging : staging_)
        if (staging.copy) static_cast<void>(staging.copy.finish());
}

bool BrickUploads::is_idle() const
{
    return std::ranges::all_of(staging_, [](const Staging& staging) { return !staging.copy || staging.copy.done(); });
}

}  // namespace shvr
