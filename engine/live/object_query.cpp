#include "engine/live/object_query.h"

#include <cstring>
#include <utility>

#include "engine/passes/paint.h"

namespace shvr {

namespace {

void check_words(const RelevanceBits& bits)
{
    const Size3 size = bits.box.size();
    SHVR_CHECK(size.x > 0 && size.y > 0 && size.z > 0 && bits.words_per_row == (size.x + 31) / 32);
    SHVR_CHECK(bits.words.size() == size_t(bits.words_per_row * size.y * size.z), bits.words.size());
}

}  // namespace

void ObjectQuery::ask(std::span<const Growth> growths)
{
    SHVR_CHECK(!growths.empty());
    FrameGraph graph;
    places_.clear();
    for (const Growth& growth : growths) {
        const RelevanceBits& mask = growth.mask;
        const RelevanceBits& seeds = growth.seeds;
        check_words(mask);
        check_words(seeds);
        if (mask.level != seeds.level)
            fail("the object: its seeds are of level ", seeds.level, ", and what it is grown in of level ", mask.level,
                 "; expected the same");
        const gpu::RegionParams params{.size = glm::uvec3(mask.box.size()),
                                       .words_per_row = uint32_t(mask.words_per_row),
                                       .connectivity = 6,
                                       .seed = gpu::NO_SEED};
        const SeedBits held{.words = graph.upload("object seeds", std::span<const uint32_t>(seeds.words)),
                            .size = glm::uvec3(seeds.box.size()),
                            .words_per_row = uint32_t(seeds.words_per_row),
                            .from_region = glm::ivec3(mask.box.lower - seeds.box.lower)};
        const Resource bits = graph.upload("object mask", std::span<const uint32_t>(mask.words));
        graph.read_back(select_object(graph, params, bits, held), "grown object");
        places_.push_back({.box = mask.box, .words_per_row = mask.words_per_row, .words = {}, .level = mask.level});
    }
    frame_ = renderer_.executor().submit(std::move(graph));
}

std::vector<RelevanceBits> ObjectQuery::answer()
{
    SHVR_CHECK(is_asking());
    const gpu::FrameResult result = std::exchange(frame_, {}).finish();
    for (size_t i = 0; i < places_.size(); ++i) {
        const std::vector<std::byte>& bytes = result.read_backs[i];
        places_[i].words.resize(bytes.size() / sizeof(uint32_t));
        std::memcpy(places_[i].words.data(), bytes.data(), bytes.size());
    }
    return std::exchange(places_, {});
}

}  // namespace shvr
