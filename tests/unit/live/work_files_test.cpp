// The files of a session's work (engine/live/annotator.h).

#include <cstring>

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_image.h"
#include "engine/live/annotator.h"
#include "engine/projects/import_volume.h"
#include "engine/session/session.h"
#include "engine/volume/content_hash.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// A volume with one stored block, large enough for a hash in chunks, and tall, so that its slices are small.
class LoneBlock final : public VolumeSource {
public:
    LoneBlock() : VolumeSource({.size = Size3(96, 96, 1 << 17), .type = VoxelType::uint8}) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        std::byte* to = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                    const bool is_stored = x < 64 && y >= 64 && z / 64 == 5;
                    *to++ = is_stored ? std::byte(1 + (x + y + z) % 200) : std::byte{0};
                }
    }
    Size3 block() const override { return Size3(64); }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t) const override
    {
        if (level != 0) return std::nullopt;
        return StoredBlocks{.block = Size3(64), .blocks = {{0, 1, 5}}};
    }
};

}  // namespace

TEST_CASE("annotation that names its volume by the other kind of hash is of the same image")
{
    const TemporaryFolder folder;
    const LoneBlock source;
    import_volume(source, folder.path / "block", folder.path / "p", {});
    const OpenedSession opened = open_session(folder.path / "p");
    const WorkFiles files = work_files(opened.session, opened.source->info());
    CHECK(kind_of(files.volume_hash) == HashKind::chunks);
    const std::string slices = content_hash(source);  // as an import of all voxels by an earlier version has it
    CHECK(files.is_other_name(slices));
    std::string other = slices;
    other.back() = other.back() == '0' ? '1' : '0';
    CHECK(!files.is_other_name(other));
    CHECK(!files.is_other_name("xxh3-128-chunks:0"));
    const std::filesystem::path mask = folder.path / "old.mask";
    save_mask_image(mask, slices);
    check_mask_image(mask, files.volume_hash, files.is_other_name);
    CHECK(contains(error_of([&] { check_mask_image(mask, files.volume_hash); }), "painted on other voxels"));
    save_mask_image(mask, other);
    CHECK(contains(error_of([&] { check_mask_image(mask, files.volume_hash, files.is_other_name); }),
                   "painted on other voxels"));
}
