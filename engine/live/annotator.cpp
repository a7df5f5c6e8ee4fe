#include "engine/live/annotator.h"

#include <array>
#include <cmath>
#include <utility>

#include "engine/session/kept_settings.h"
#include "engine/session/lasting_settings.h"
#include "engine/session/words/number_words.h"
#include "engine/volume/content_hash.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Distance, in voxels, up to which an offset changes the picture through interpolation and gradients.
constexpr int64_t RAISED_REACH = 2;

VoxelBox reach_of_raised(const VoxelBox& raised, const Size3& size)
{
    const VoxelBox reach = grown(raised, RAISED_REACH);
    return {glm::max(reach.lower, Size3(0)), glm::min(reach.upper, size)};
}

std::string label_of(const PaintOp& op)
{
    const std::string with = sentence(" with ", row_of(op.brush).name);
    const std::string painted = op.erases() ? "erased voxels" : sentence("painted group ", int(op.group));
    if (!op.density) return painted + with;
    const double offset = op.erases() ? 0.0 : *op.density->offset;
    const std::string density = offset == 0.0 ? "reset the density"
                                              : sentence(offset > 0.0 ? "raised" : "lowered", " the density by ",
                                                         number_in_words(std::abs(offset)));
    return (op.paints_group ? painted + " and " + density : density) + with;
}

}  // namespace

PaintOp in_session(PaintOp op, const Session& session)
{
    if (op.density && !op.density->offset)
        op.density->offset = automatic_offset(session.transfer_function.lower(), op.threshold);
    op.locked = locked_groups(session.groups);
    return op;
}

WorkFiles work_files(const Session& session, const VolumeInfo& volume)
{
    return {.journal = session.journal_path,
            .mask = session.mask_path,
            .trace = session.trace_path,
            .density = session.density_path,
            .volume_hash = session.volume_hash,
            .is_other_name =
                [session = std::make_shared<const Session>(session)](const std::string& hash) {
                    const std::optional<HashKind> kind = kind_of(hash);
                    if (!kind || kind == kind_of(session->volume_hash)) return false;
                    return is_same_content(hash, session->volume_hash, open_source(*session).get());
                },
            .volume = volume};
}

WorkFiles work_files(const Session& session, const VolumeInfo& volume, const std::vector<std::string>& overridden)
{
    WorkFiles files = work_files(session, volume);
    files.settings = without_overridden(lasting_settings(session), overridden);
    files.normalized = normalized_settings;
    return files;
}

WorkFiles with_kept_settings(WorkFiles files, const Session& session, const std::vector<std::string>& overridden)
{
    files.kept = without_overridden(kept_settings(session), overridden);
    files.normalized_kept = normalized_kept_settings;
    return files;
}

Annotator::Annotator(Renderer& renderer)
    : Annotator(renderer, std::make_unique<Work>(renderer.volume().info().size, renderer.volume().info().type))
{}

Annotator::Annotator(Renderer& renderer, std::unique_ptr<Work> work) : renderer_(renderer), work_(std::move(work)) {}

std::vector<Notice> Annotator::open(const WorkFiles& files, const Work::Opening& opening)
{
    std::vector<Notice> notices = work_->open(files, opening);
    renderer_.scene().show(document());
    ++revision_;
    return notices;
}

std::vector<Notice> Annotator::choose(Belief belief)
{
    SHVR_CHECK(!stroke_is_running());
    Work::Choice choice = work_->choose(belief);
    if (choice.command) show(*choice.command);
    return std::move(choice.notices);
}

// ---- What a brush selects -------------------------------------------------------------------------------------------

Annotator::Answered Annotator::nothing_yet(const PaintOp& op) const
{
    const VolumeInfo& info = renderer_.volume().info();
    Answered answered{.selection = VoxelSelection(info.size), .density = std::nullopt};
    if (!op.density) return answered;
    SHVR_CHECK(op.density->offset || op.erases(), "an offset that nobody has chosen");
    if (op.erases())
        answered.density.emplace(info.size, info.spacing, info.type, 0.0, Falloff::flat);
    else
        answered.density.emplace(info.size, info.spacing, info.type, *op.density->offset, op.density->falloff);
    return answered;
}

void Annotator::add(Answered& answered, const PaintOp& op, std::span<const RegionAnswer> answers)
{
    for (const RegionAnswer& one : answers) {
        answered.selection.add(one.region, one.words);
        if (answered.density) answered.density->add(one.region, one.words, one.centre_voxel, op.radius_voxels);
    }
}

Annotator::Answered Annotator::ask(const PaintOp& op)
{
    const std::vector<glm::dvec3> positions = stroke_positions(op.path);
    Answered answered = nothing_yet(op);
    RegionQuery query(renderer_);
    for (size_t next = 0; next < positions.size();) {
        FrameOfRegions frame = frame_of_regions(op, positions, next, renderer_.volume().info());
        next = frame.end;
        if (frame.regions.empty()) break;
        query.ask(op, std::move(frame.regions), RegionQuery::Wait::for_bricks);
        add(answered, op, query.answer());
    }
    return answered;
}

Annotator::Records Annotator::records_of(const PaintOp& op, const Answered& answered) const
{
    Records records;
    if (op.paints_group) records.groups = paint_changes(document().mask, answered.selection, rule_of(op));
    if (answered.density) records.offsets = answered.density->changes(document().density);
    return records;
}

std::vector<Change> Annotator::changes_of(Records records)
{
    std::vector<Change> changes = as_changes(std::move(records.groups));
    for (DensityBrickChange& change : records.offsets) changes.emplace_back(std::move(change));
    return changes;
}

VoxelSelection Annotator::select(const PaintOp& op)
{
    PaintOp groups_alone = op;
    groups_alone.density.reset();
    return ask(groups_alone).selection;
}

PaintPreview Annotator::preview_of_answer(const PaintOp& op, const Answered& answered) const
{
    const PaintPreview::Kind kind = op.erases()       ? PaintPreview::Kind::erase
                                    : op.paints_group ? PaintPreview::Kind::group
                                                      : PaintPreview::Kind::density;
    return preview_of(changes_of(records_of(op, answered)), document().mask.size(), kind);
}

PaintPreview Annotator::preview(const PaintOp& op)
{
    return preview_of_answer(op, ask(op));
}

PaintPreview Annotator::preview(const PaintOp& op, std::span<const RegionAnswer> answers) const
{
    Answered answered = nothing_yet(op);
    add(answered, op, answers);
    return preview_of_answer(op, answered);
}

// ---- Painting -------------------------------------------------------------------------------------------------------

int64_t Annotator::paint(const PaintOp& op)
{
    SHVR_CHECK(!stroke_is_running());
    const Answered answered = ask(op);
    Records records = records_of(op, answered);
    StrokeTally tally(op);
    tally.add(document().mask, answered.selection, records.groups, records.offsets);
    const Command* const command = work_->perform({label_of(op), changes_of(std::move(records))});
    if (command) show(touched_by(document(), command->changes));
    last_stroke_ = tally.result();
    return last_stroke_.voxels();
}

void Annotator::begin_stroke(const PaintOp& brush)
{
    SHVR_CHECK(!stroke_is_open());
    strokes_.push_back(Stroke{.brush = brush, .query = RegionQuery(renderer_)});
}

void Annotator::begin_whole_stroke(const PaintOp& op)
{
    SHVR_CHECK(!stroke_is_open());
    strokes_.push_back({.brush = op,
                        .query = RegionQuery(renderer_),
                        .positions = stroke_positions(op.path),
                        .has_ended = true,
                        .whole = nothing_yet(op)});
}

void Annotator::extend_stroke(const glm::dvec3& voxel)
{
    SHVR_CHECK(stroke_is_open());
    Stroke& stroke = strokes_.back();
    const glm::dvec3 from = stroke.last.value_or(voxel);
    const std::vector<glm::dvec3> more = stroke_positions(std::array{from, voxel});
    // A segment's first position is the last position of the previous segment, so it is skipped. A dab is a segment
    // from a point to itself, with two equal positions; the second one is kept.
    stroke.positions.insert(stroke.positions.end(), more.begin() + 1, more.end());
    stroke.last = voxel;
}

void Annotator::end_stroke()
{
    SHVR_CHECK(stroke_is_open());
    strokes_.back().has_ended = true;
}

void Annotator::drop_strokes()
{
    if (!strokes_.empty()) last_stroke_ = strokes_.front().result;
    strokes_.clear();
}

void Annotator::drop_queries()
{
    for (Stroke& stroke : strokes_) stroke.query.drop();
}

void Annotator::drop_first_stroke()
{
    last_stroke_ = strokes_.front().result;
    strokes_.pop_front();
}

std::optional<VoxelBox> Annotator::advance()
{
    std::optional<VoxelBox> changed = advance_first_stroke();
    if (is_behind()) catch_up();
    return changed;
}

std::optional<VoxelBox> Annotator::advance_first_stroke()
{
    if (strokes_.empty()) return std::nullopt;
    constexpr const char* CUT = "; the rest of the stroke is not painted";
    try {
        std::optional<VoxelBox> changed = advance_stroke();
        if (!strokes_.empty()) strokes_.front().failed_tries = 0;
        return changed;
    } catch (const gpu::DeviceLost&) {
        throw;  // the caller restarts the device, and then the stroke continues
    } catch (const gpu::MemoryError& error) {
        strokes_.front().query.drop();
        const bool is_of_budget = dynamic_cast<const gpu::BudgetError*>(&error) != nullptr;  // a budget does not change
                                                                                             // by waiting
        if (!is_of_budget && ++strokes_.front().failed_tries < MAX_TRIES) throw;
        drop_first_stroke();
        fail(error.what(), CUT);
    } catch (const Error& error) {  // a part of the stroke that cannot be recorded is not painted
        drop_first_stroke();
        fail(error.what(), CUT);
    }
}

std::optional<VoxelBox> Annotator::advance_stroke()
{
    Stroke& stroke = strokes_.front();
    std::optional<VoxelBox> changed;
    if (stroke.query.is_asking()) {
        if (!stroke.query.is_answered()) return std::nullopt;
        changed = paint_answer();
    }
    if (stroke.next < stroke.positions.size()) {
        if (renderer_.scene().awaits_voxels()) return changed;  // brushes see all offsets painted before
        FrameOfRegions frame = frame_of_regions(stroke.brush, stroke.positions, stroke.next, renderer_.volume().info());
        if (frame.regions.empty())
            stroke.next = frame.end;
        else if (stroke.query.ask(stroke.brush, std::move(frame.regions), RegionQuery::Wait::no))
            stroke.asked_to = frame.end;  // else: nothing was submitted, since bricks are still being loaded
    } else if (stroke.has_ended) {
        if (stroke.whole) changed = paint_whole();
        last_stroke_ = stroke.result;
        ++strokes_done_;
        strokes_.pop_front();
    }
    return changed;
}

std::optional<VoxelBox> Annotator::paint_answer()
{
    Stroke& stroke = strokes_.front();
    const std::vector<RegionAnswer> answers = stroke.query.answer();
    if (stroke.whole) {
        add(*stroke.whole, stroke.brush, answers);
        stroke.next = stroke.asked_to;
        return std::nullopt;
    }
    Answered answered = nothing_yet(stroke.brush);
    add(answered, stroke.brush, answers);
    Records records = records_of(stroke.brush, answered);
    stroke.tally.add(document().mask, answered.selection, records.groups, records.offsets);
    std::vector<Change> changes = changes_of(std::move(records));
    if (changes.empty()) {
        stroke.next = stroke.asked_to;
        stroke.result = stroke.tally.result();
        return std::nullopt;
    }
    const Touched touched = touched_by(document(), changes);
    if (stroke.is_recorded)
        work_->extend(std::move(changes));
    else
        work_->perform({label_of(stroke.brush), std::move(changes)});
    stroke.is_recorded = true;
    stroke.next = stroke.asked_to;
    stroke.result = stroke.tally.result();
    VoxelBox box = answers.front().region.box;
    for (const RegionAnswer& answer : answers) box = united(box, answer.region.box);
    show(touched, box);
    return touched.raised.empty() ? box : reach_of_raised(box, document().mask.size());
}

/// Paints the answers of all regions of the first stroke, as one command.
std::optional<VoxelBox> Annotator::paint_whole()
{
    Stroke& stroke = strokes_.front();
    Records records = records_of(stroke.brush, *stroke.whole);
    stroke.tally.add(document().mask, stroke.whole->selection, records.groups, records.offsets);
    stroke.result = stroke.tally.result();
    const Command* const command = work_->perform({label_of(stroke.brush), changes_of(std::move(records))});
    if (!command) return std::nullopt;
    const Touched touched = touched_by(document(), command->changes);
    show(touched);
    return VoxelBox{Size3(0), document().mask.size()};
}

void Annotator::show(const Touched& touched, const std::optional<VoxelBox>& within)
{
    revision_ += !touched.mask_bricks.empty() || !touched.raised.empty();
    try_to_show([&] { renderer_.scene().show(document(), touched, within); });
}

/// Shows a change that has already been made. If showing the change fails, the change itself stays.
template <class Update>
void Annotator::try_to_show(const Update& update)
{
    tries_to_show_ = 0;
    try {
        update();
    } catch (const Error&) {
        if (!renderer_.scene().is_behind()) throw;
    }
}

void Annotator::catch_up()
{
    ++tries_to_show_;
    try {
        renderer_.scene().catch_up(document());
    } catch (const gpu::BudgetError&) {
        tries_to_show_ = MAX_TRIES;  // the picture stays behind until something changes
        throw;
    }
    if (renderer_.scene().awaits_voxels()) {
        --tries_to_show_;
        return;
    }
    ++revision_;
}

// ---- The trace, and the history -------------------------------------------------------------------------------------

const Command* Annotator::edit_trace(std::string label, std::vector<TraceChange> changes)
{
    return perform(std::move(label), as_changes(std::move(changes)));
}

const Command* Annotator::perform(std::string label, std::vector<Change> changes)
{
    SHVR_CHECK(!stroke_is_running());
    const Command* command = work_->perform({std::move(label), std::move(changes)});
    if (command) show(*command);
    return command;
}

const Command* Annotator::change_settings(std::string label, const SettingValues& values)
{
    SHVR_CHECK(!stroke_is_running());
    return work_->change_settings(std::move(label), values);
}

const Command* Annotator::undo()
{
    const Command* command = stroke_is_running() ? nullptr : work_->undo();
    if (command) show(*command);
    return command;
}

const Command* Annotator::redo()
{
    const Command* command = stroke_is_running() ? nullptr : work_->redo();
    if (command) show(*command);
    return command;
}

const Command* Annotator::revert()
{
    const Command* command = stroke_is_running() ? nullptr : work_->revert();
    if (command) show(*command);
    return command;
}

void Annotator::show(const Command& command)
{
    const Touched touched = touched_by(document(), command.changes);
    revision_ += !touched.mask_bricks.empty() || !touched.raised.empty();
    try_to_show([&] { renderer_.scene().show(document(), command.changes); });
}

}  // namespace shvr
