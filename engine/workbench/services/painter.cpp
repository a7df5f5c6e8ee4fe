#include "engine/workbench/services/painter.h"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <thread>

#include "engine/remote/address.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

/// Time after which a stroke that waits for bricks is abandoned, if no new brick arrives.
constexpr double PATIENCE_S = 20.0;

/// Returns whether a stroke found almost no voxels to paint, compared with the volume within the brush's radius.
bool is_hardly_any(const StrokeResult& result, const glm::dvec3& spacing)
{
    constexpr double HARDLY = 0.05;
    const double radius = result.stroke.radius_voxels * spacing.x;
    const double share_of_box = result.stroke.region == RegionShape::ball ? std::numbers::pi / 6.0 : 1.0;
    const double reached = share_of_box * 8.0 * radius * radius * radius / (spacing.x * spacing.y * spacing.z);
    return double(result.voxels() + result.kept_painted) < HARDLY * reached;
}

}  // namespace

Painter::Painter(Desk& desk, PreferenceKeeper& keeper, Others others)
    : Service(desk), keeper_(keeper), others_(std::move(others))
{}

void Painter::advance()
{
    attempt(painting_, [this] { follow_stroke(); });
    attempt(previewing_, [this] { follow_preview(); });
}

bool Painter::is_stuck() const
{
    return options_.now_s() - stroke_progress_s_ > PATIENCE_S;
}

std::string Painter::why_stuck()
{
    return sentence("its bricks did not arrive within ", PATIENCE_S, " s");
}

void Painter::act(const Paint& action)
{
    Annotator& annotator = document_->annotator;
    if (document_->session.probe.tool == Tool::trace) {
        if (action.on) others_.add_node_here();
        return;
    }
    if (action.on) annotator.work().refuse_if_only_looking();
    if (action.on && !annotator.stroke_is_open()) {
        if (others_.has_settings_to_record() || document_->drags_node)
            await_strokes();  // in the history they come before
        if (document_->drags_node) others_.stop_drag();
        const Previewer& previewer = document_->previewer;
        if (previewer.shown() && previewer.is_current()) previewed_at_stroke_ = previewer.shown()->voxels;
        check_radius(document_->brush().radius_voxels, document_->volume().spacing, document_->volume().size);
        others_.record_settings();
        annotator.begin_stroke(document_->stroke());
        stroke_end_voxel_ = document_->tool_voxel();
        annotator.extend_stroke(stroke_end_voxel_);
    } else if (!action.on && annotator.stroke_is_open()) {
        extend_stroke();
        annotator.end_stroke();
    }
}

void Painter::act(const PaintOp& op)
{
    Annotator& annotator = document_->annotator;
    annotator.work().refuse_if_only_looking();
    const bool is_queued = annotator.stroke_is_running() && !annotator.stroke_is_open() && paints_later() &&
                           !others_.has_settings_to_record();
    if (annotator.stroke_is_running() && !is_queued) fail("a stroke is being painted; expected it to have ended");
    if (!is_queued) others_.record_settings();
    const PaintOp stroke = in_session(op, document_->session);
    if (paints_later()) return annotator.begin_whole_stroke(stroke);
    annotator.paint(stroke);
    stroke_ended();
}

/// Whether the bricks of a stroke may have to come over a network, for which a window does not wait.
bool Painter::paints_later() const
{
    return renderer_.scene().reads_in_background();
}

void Painter::extend_stroke()
{
    if (!document_->annotator.stroke_is_open() || document_->tool_voxel() == stroke_end_voxel_) return;
    stroke_end_voxel_ = document_->tool_voxel();
    document_->annotator.extend_stroke(stroke_end_voxel_);
    if (log_ && document_->touch.servo()) {
        const bool slices_stay = document_->session.view.slices.cross.has_value();
        log_(line_of(PlaceProbe{.voxel = stroke_end_voxel_, .hovers = slices_stay}));
    }
}

void Painter::follow_stroke()
{
    Annotator& annotator = document_->annotator;
    if (annotator.work().look_for_claim()) say(annotator.work().claimed(), Weight::error);
    if (document_->holder.empty()) document_->holder = annotator.work().claimed_by();
    const std::string failure = annotator.work().journal().failure;
    if (failure != journal_failure_)
        say(failure.empty() ? "The journal can be written again: all work is kept" : failure,
            failure.empty() ? Weight::done : Weight::error);
    journal_failure_ = failure;
    if (!annotator.stroke_is_running() && !annotator.is_behind()) return;
    extend_stroke();
    const uint64_t done = annotator.strokes_done();
    advance_stroke();
    if (annotator.strokes_done() != done) stroke_ended();
}

void Painter::note_trouble(const std::string& failure)
{
    const bool is_about_journal = failure.starts_with(document_->session.journal_path.string() + ": ");
    if (is_about_journal && document_->unsavable.empty() && !document_->only_looks()) document_->unsavable = failure;
}

void Painter::advance_stroke()
{
    bool has_painted = false;
    try {
        has_painted = document_->annotator.advance().has_value();
    } catch (const Error& error) {
        note_trouble(error.what());
        throw;
    }
    const uint64_t before =
        std::exchange(stroke_uploads_, renderer_.volume().counts().value_or(DeviceVolume::Counts{}).uploads);
    if (has_painted || before != stroke_uploads_) stroke_progress_s_ = options_.now_s();
}

/// Waits until strokes that have ended are fully painted, before other changes of annotation. The wait takes
/// milliseconds unless bricks come from a slow disk or a network. It ends after 2 s at most, after a tenth of a second
/// if the volume is on another machine; the change then fails, and states why.
void Painter::await_strokes()
{
    constexpr double MAX_WAIT_S = 2.0, MAX_WAIT_FOR_NETWORK_S = 0.1;
    constexpr std::chrono::microseconds TURN(200);
    const Annotator& annotator = document_->annotator;
    const bool is_far = !document_->is_script() && leads_to_network(document_->session.volume_path);
    const double until = options_.now_s() + (is_far ? MAX_WAIT_FOR_NETWORK_S : MAX_WAIT_S);
    while (annotator.stroke_is_running() && !annotator.stroke_is_open() && options_.now_s() < until) {
        attempt(painting_, [this] { follow_stroke(); });
        renderer_.scene().advance();
        std::this_thread::sleep_for(TURN);
    }
}

std::string Painter::finish_stroke()
{
    constexpr std::chrono::milliseconds TURN(1), AGAIN(250);
    Annotator& annotator = document_->annotator;
    extend_stroke();
    if (annotator.stroke_is_open()) annotator.end_stroke();
    std::string unpainted;
    stroke_progress_s_ = options_.now_s();
    while (annotator.stroke_is_running()) {
        const bool was_tried = tries_stroke(unpainted);
        renderer_.scene().advance();
        if (is_stuck()) {
            annotator.drop_strokes();
            unpainted = why_stuck();
        }
        std::this_thread::sleep_for(was_tried ? TURN : AGAIN);
    }
    return unpainted;
}

/// Advances the stroke. Returns false while memory is insufficient. Stores the reason of other failures in `unpainted`.
bool Painter::tries_stroke(std::string& unpainted)
{
    try {
        follow_stroke();
        return true;
    } catch (const gpu::MemoryError&) {
        return false;
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const Error& error) {
        unpainted = error.what();
        return true;
    }
}

void Painter::stroke_ended()
{
    const StrokeResult& result = document_->annotator.last_stroke();
    const bool takes_from_others = !result.taken_from.empty() && !result.stroke.erases();
    const bool is_as_meant = !takes_from_others && result.kept_by_locks() == 0;
    std::string said =
        sentence_of(result, [&](uint8_t group) { return group_of(document_->session.groups, group).name; });
    if (is_as_meant && !result.stroke.erases() && is_hardly_any(result, document_->volume().spacing))
        said += how_to_reach_this();
    others_.note_stroke(result.voxels() == 0);
    if (result.voxels() != 0) document_->painted_at = document_->touch.probe();
    say(said, is_as_meant ? Weight::done : Weight::warning);
}

/// If the voxel under the probe is below the paint threshold, returns its value and the key that sets the threshold.
std::string Painter::how_to_reach_this() const
{
    const Model now = desk_.model();
    const Reading& here = now.reading;
    if (!here.is_inside || !here.intensity || *here.intensity + here.offset >= now.paint_threshold()) return {};
    return "; here is " + value_in_words(here) +
           keeper_.with_key(", and ", "threshold_here", " sets the threshold from it");
}

/// Updates the preview of the brush. Shows no preview during a stroke, since the stroke itself shows its effect.
void Painter::follow_preview()
{
    Document& document = *document_;
    const ProbeSettings& probe = document.session.probe;
    const bool is_asked_for = probe.preview.has_value(), is_refused = !is_asked_for && unpreviewed_ == probe.brush;
    const bool is_wanted = probe.previews() && !is_refused && !(document.is_script() && !is_asked_for) &&
                           !document.annotator.stroke_is_running();
    document.previewer.want(is_wanted ? std::optional(document.dab()) : std::nullopt);
    try {
        document.previewer.advance();
    } catch (const Error& error) {
        const bool is_of_budget = dynamic_cast<const gpu::BudgetError*>(&error) != nullptr;
        if (dynamic_cast<const gpu::DeviceLost*>(&error) != nullptr) throw;
        if (dynamic_cast<const gpu::MemoryError*>(&error) != nullptr && !is_of_budget) throw;  // there may be some soon
        // The brush is too large for a preview, or a file cannot be read: switch the preview off; for this brush
        // only, and without a word, if it is there by default.
        document.previewer.want(std::nullopt);
        if (!is_asked_for) {
            unpreviewed_ = probe.brush;
            return;
        }
        document.session.probe.preview = false;
        others_.note_edit();
        say(error.what(), Weight::error);
    }
}

PaintModel Painter::model() const
{
    if (!document_) return {};
    const Previewer& previewer = document_->previewer;
    const bool has_preview = previewer.shown() && previewer.is_current();
    return {.is_painting = document_->annotator.stroke_is_running(),
            .stroke_is_open = document_->annotator.stroke_is_open(),
            .previewed_voxels = has_preview ? std::optional(previewer.shown()->voxels) : std::nullopt,
            .voxels_by_group = document_->annotator.document().mask.voxels_by_group()};
}

}  // namespace shvr::ui
