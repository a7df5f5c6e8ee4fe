#include "engine/annotation/work/work_offsets.h"

#include "engine/base/error.h"

namespace shvr {

std::vector<OffsetSource::Brick> offset_bricks(const DensityField& field)
{
    std::vector<OffsetSource::Brick> bricks;
    for (const int64_t brick : field.painted_bricks()) bricks.push_back({field.position_of(brick), field.brick(brick)});
    return bricks;
}

std::shared_ptr<const VolumeSource> with_offsets(std::shared_ptr<const VolumeSource> base, const DensityField& field)
{
    SHVR_CHECK(field.size() == base->info().size && field.type() == base->info().type,
               "the offsets are of another volume");
    if (field.voxels() == 0) return base;
    auto raised = std::make_shared<OffsetSource>(std::move(base));
    raised->set(offset_bricks(field));
    return raised;
}

DensityField offsets_of(const WorkFiles& files, Belief belief, std::vector<Notice>& notices)
{
    WorkFiles looked_at = files;
    std::error_code ignored;
    if (files.journal.empty() || !std::filesystem::exists(files.journal, ignored)) {
        looked_at.journal.clear();
        looked_at.mask.clear();
        looked_at.trace.clear();
    }
    if (std::optional<Notice> notice = note_missing_journal(files)) notices.push_back(std::move(*notice));
    Work work(files.volume.size, files.volume.type);
    for (Notice& notice : work.open(looked_at, {.belief = belief, .only_look = true}))
        notices.push_back(std::move(notice));
    for (const Dispute& dispute : work.disputes())
        if (dispute.part == Part::offsets) throw Disputed(dispute.text);
    return work.document().density;
}

}  // namespace shvr
