#include "engine/volume/content_hash.h"

#include <random>

#include <doctest/doctest.h>

#include "engine/projects/import_volume.h"
#include "engine/session/session.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Asks to be read in blocks.
class Blocks final : public MemorySource {
public:
    Blocks(const MemorySource& source, const Size3& block) : MemorySource(source), block_(block) {}
    Size3 block() const override { return block_; }

private:
    Size3 block_;
};

template <class T>
MemorySource noise(VoxelType type, const Size3& size)
{
    std::mt19937 numbers(11);
    std::vector<T> voxels(size_t(size.x * size.y * size.z));
    for (T& voxel : voxels) voxel = static_cast<T>(numbers() % 1000);
    return memory_source(size, type, voxels);
}

std::string hash_of_measuring(const VolumeSource& source)
{
    const HashedSource hashed(source);
    CHECK(hashed.hash().empty());
    measure(hashed);
    return hashed.hash();
}

}  // namespace

TEST_CASE("measuring a volume hashes it, whatever blocks it is read in")
{
    const Size3 size{21, 34, 17};
    const MemorySource plain = noise<uint16_t>(VoxelType::uint16, size);
    const std::string hash = content_hash(plain);
    CHECK(hash_of_measuring(plain) == hash);
    for (const Size3 block : {Size3(8), Size3(64), Size3(1, 1, 5), Size3(21, 34, 1)}) {
        CHECK(content_hash(Blocks(plain, block)) == hash);
        CHECK(hash_of_measuring(Blocks(plain, block)) == hash);
    }
    // Gone through more than once.
    const MemorySource wide = noise<float>(VoxelType::float32, size);
    CHECK(hash_of_measuring(wide) == content_hash(wide));
    CHECK(content_hash(wide) != hash);
    // 36 MiB a slice: slabs are parts of slices.
    const MemorySource large = noise<uint8_t>(VoxelType::uint8, {6144, 6144, 2});
    CHECK(hash_of_measuring(large) == content_hash(large));
}

TEST_CASE("a session knows the hash of its volume, a project's and a file's alike")
{
    const TemporaryFolder folder;
    const MemorySource source = noise<uint8_t>(VoxelType::uint8, {40, 33, 20});
    std::string bytes(40 * 33 * 20, '\0');
    source.read({Size3(0), source.info().size}, std::as_writable_bytes(std::span(bytes)));
    const auto raw = folder.write("a_40x33x20_uint8.raw", bytes);
    import_volume(source, raw, folder.path / "project", {});
    CHECK(open_session(raw).session.volume_hash == content_hash(source));
    CHECK(open_session(folder.path / "project").session.volume_hash == content_hash(source));
    // Nothing is taken from an invalid record.
    folder.write("project/shvr/volume.json", "{}");
    CHECK(open_session(folder.path / "project").session.volume_hash == content_hash(source));
}
