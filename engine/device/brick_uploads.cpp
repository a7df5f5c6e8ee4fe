#include "engine/device/brick_uploads.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace shvr {

BrickUploads::BrickUploads(gpu::Executor& executor, gpu::Memory& memory, uint64_t bricks, AtlasCodes codes)
    : executor_(executor),
      codes_(codes),
      unpacks_(!memory.traits().is_cpu),
      batch_(size_t(std::clamp<uint64_t>(bricks, 1, BATCH)))
{
    for (Staging& staging : staging_)
        staging.bytes = memory.create("brick staging", buffer_desc(ranges_at(batch_)), gpu::Placement::upload,
                                      "the transfer of the volume");
}

namespace {

/// `Code`: uint16_t, or uint8_t if all codes are multiples of 257 (8-bit volumes).
template <class Code>
void write_codes(const BrickTexels& texels, const glm::ivec3& begin, const glm::ivec3& end, std::byte* to)
{
    constexpr int APRON = gpu::BRICK_APRON, SIDE = gpu::BRICK_TEXELS;
    std::array<Code, SIDE> row;
    for (int z = begin.z; z < end.z; ++z)
        for (int y = begin.y; y < end.y; ++y) {
            const uint16_t* from = &texels.codes[size_t(SIDE * (y + APRON + SIDE * (z + APRON)))];
            for (int x = 0; x < SIDE; ++x) row[size_t(x)] = Code(from[x] >> 8 * (2 - sizeof(Code)));
            const int first = std::max(begin.x, -APRON), last = std::min(end.x, SIDE - APRON);
            for (int x = begin.x; x < first; ++x, to += sizeof(Code)) std::memcpy(to, row.data(), sizeof(Code));
            std::memcpy(to, &row[size_t(first + APRON)], size_t(last - first) * sizeof(Code));
            to += size_t(last - first) * sizeof(Code);
            for (int x = last; x < end.x; ++x, to += sizeof(Code)) std::memcpy(to, &row.back(), sizeof(Code));
        }
}

}  // namespace

void BrickUploads::stage(const Target& target, const BrickTexels& texels)
{
    if (targets_.size() == batch_) flush();  // if the buffer is full here, flush() failed when the buffer was filled
    Staging& staging = staging_[filling_];
    if (staging.copy) static_cast<void>(staging.copy.finish());
    std::byte* bytes = staging.bytes.mapped().data();
    const auto write = codes_ == AtlasCodes::exact8 ? write_codes<uint8_t> : write_codes<uint16_t>;
    write(texels, target.begin, target.end, bytes + codes_at(targets_.size()));
    std::memcpy(bytes + ranges_at(targets_.size()), texels.cell_ranges.data(), BrickTexels::RANGE_BYTES);
    targets_.push_back(target);
    if (targets_.size() == batch_) flush();
}

void BrickUploads::flush()
{
    if (targets_.empty()) return;
    FrameGraph graph;
    const Resource staged = graph.import("brick staging", staging_[filling_].bytes.import());
    if (unpacks_ || targets_.front().codes->desc().by_address)
        add_kernels(graph, staged);
    else
        add_copies(graph, staged);
    staging_[filling_].copy = executor_.submit(std::move(graph), {.timestamps = false});
    filling_ = 1 - filling_;
    upload_count_ += targets_.size();
    targets_.clear();
}

namespace {

/// Groups the bricks by destination image.
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
    const glm::uvec3 of_texel(codes_a_texel(codes_), 1, 1);
    for_each_image(
        targets_, [](const Target& target) { return target.codes; },
        [&](const gpu::Storage& image, const std::vector<uint32_t>& bricks) {
            std::vector<ImageRegion> regions;
            for (const uint32_t brick : bricks)
                regions.push_back({codes_at(brick), targets_[brick].code / of_texel, extent_of(brick) / of_texel});
            static_cast<void>(graph.copy_to_image(staged, graph.import("atlas", image.import()), std::move(regions),
                                                  "upload bricks"));
        });
    for_each_image(
        targets_, [](const Target& target) { return target.cells; },
        [&](const gpu::Storage& image, const std::vector<uint32_t>& bricks) {
            std::vector<ImageRegion> regions;
            for (const uint32_t brick : bricks)
                regions.push_back({ranges_at(brick), targets_[brick].cell, glm::uvec3(gpu::BRICK_CELLS)});
            static_cast<void>(graph.copy_to_image(staged, graph.import("cell ranges", image.import()),
                                                  std::move(regions), "upload cell ranges"));
        });
}

/// Adds one dispatch for each code image that receives bricks of this batch.
void BrickUploads::add_kernels(FrameGraph& graph, Resource staged) const
{
    Resource cells = graph.import("cell ranges", targets_.front().cells->import());
    for_each_image(
        targets_, [](const Target& target) { return target.codes; },
        [&](const gpu::Storage& image, const std::vector<uint32_t>& bricks) {
            std::vector<gpu::BrickUnpackJob> jobs;
            for (const uint32_t brick : bricks)
                jobs.push_back({.code = targets_[brick].code,
                                .codes = uint32_t(codes_at(brick) / sizeof(uint32_t)),
                                .extent = extent_of(brick),
                                .cell = targets_[brick].cell,
                                .ranges = uint32_t(ranges_at(brick) / sizeof(uint32_t))});
            cells = brick_unpack(graph, staged, graph.import("atlas", image.import()), codes_, image.desc().by_address,
                                 cells, jobs);
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
