#include "engine/formats/coarser.h"

#include <utility>

#include "engine/base/error.h"

namespace shvr {

namespace {

VolumeInfo info_of_level(const VolumeSource& source, int level)
{
    VolumeInfo info = source.info();
    const double wider = double(int64_t{1} << level);
    // Moves the origin: a coarse voxel is centred on the 2^level fine voxels per axis that it covers.
    info.origin += info.directions * (0.5 * (wider - 1.0) * info.spacing);
    info.size = size_of_level(info.size, level);
    info.spacing *= wider;
    info.warnings.push_back(sentence("level ", level, " of ", source.levels(), " (0 to ", source.levels() - 1,
                                     ") is opened: its voxels are ", wider, " times as wide as the file's finest"));
    return info;
}

class CoarserSource final : public VolumeSource {
public:
    CoarserSource(std::unique_ptr<VolumeSource> source, int level)
        : VolumeSource(info_of_level(*source, level)), source_(std::move(source)), first_(level)
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return source_->levels() - first_; }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        source_->read_level(first_ + level, box, voxels);
    }
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        return source_->brick_range(first_ + level, brick);
    }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        return source_->stored_blocks(first_ + level, most);
    }

private:
    std::unique_ptr<VolumeSource> source_;
    int first_;
};

}  // namespace

std::unique_ptr<VolumeSource> coarser(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                      int level)
{
    if (level == 0) return source;
    const int levels = source->levels();
    if (level >= levels)
        fail(path.string(), ": has no level ", level, "; expected ",
             levels == 1 ? std::string("0, the only one") : sentence("one from 0, the finest, to ", levels - 1));
    return std::make_unique<CoarserSource>(std::move(source), level);
}

}  // namespace shvr
