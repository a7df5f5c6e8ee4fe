#include "engine/workbench/services/reader.h"

#include <cmath>

#include "engine/live/densities.h"
#include "engine/remote/address.h"
#include "engine/workbench/desk/declined.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

/// Says what to do next, after a point that does not complete the measurement.
std::string next_step(MeasureKind kind, size_t points)
{
    if (kind == MeasureKind::distance) return "One end of the distance; click the other";
    if (kind == MeasureKind::path)
        return points == 1 ? "The path begins here; click its next points, the last one twice"
                           : sentence("Point ", points, " of the path; a double click or Enter ends it");
    return points == 1 ? "One side of the angle; click its vertex" : "The vertex; click the other side of the angle";
}

/// Declines a number that no measurement has, as in the log of another session.
void check_number(size_t number, const Document& document)
{
    if (number < 1 || number > document.session.measurements.size())
        decline(sentence("There is no measurement ", number));
}

}  // namespace

Reader::Reader(Desk& desk, PreferenceKeeper& keeper, Others others)
    : Service(desk), keeper_(keeper), others_(std::move(others))
{}

void Reader::advance()
{
    attempt(reading_turn_, [this] { follow_reading(); });
    for (const std::string& message : renderer_.scene().take_messages()) say(message, Weight::warning);
}

/// Returns the position of the pointer if it is over a slice; otherwise, the position of the probe.
glm::dvec3 Reader::voxel_to_read() const
{
    const Document& document = *document_;
    const std::vector<Screen::Part>& parts = document.screen.parts();
    if (!others_.pointer() || others_.pointer()->pane >= parts.size() ||
        !parts[others_.pointer()->pane].pane.shot.is_slice)
        return document.probe_voxel();
    const Pane& slice = parts[others_.pointer()->pane].pane;
    const Camera& camera = slice.shot.camera;
    return unproject(camera, slice.pixels(), others_.pointer()->pixel,
                     0.5 * (camera.near_distance + camera.far_distance)) /
           document.volume().spacing;
}

/// Reads the intensity at the probe or pointer if its voxel changed, and requests the relevant share of the probe's
/// ball. If reads from the file are slow, makes fewer of them, so that they take at most a tenth of the time.
void Reader::follow_reading()
{
    Document& document = *document_;
    reading_.voxel = voxel_to_read();
    reading_.depth =
        depth_below_surface(document.camera, document.session.cut, document.volume(), document.touch.probe());
    const glm::dvec3 voxel = glm::floor(reading_.voxel);
    const uint64_t revision = document.annotator.revision();
    const double now = options_.now_s();
    if ((voxel != read_voxel_ || revision != read_revision_) && now >= read_again_s_) {
        read_voxel_ = read_at(voxel) ? std::optional(voxel) : std::nullopt;
        read_revision_ = revision;
        const double end = options_.now_s();
        read_again_s_ = end + 9.0 * (end - now);
    }
    const ProbeSettings& probe = document.session.probe;
    const double threshold = probe.guided ? *probe.haptic_threshold : *probe.brush.threshold;
    const bool is_wanted = probe_is_measured();
    document.meter.want(
        is_wanted ? std::optional(ProbeMeter::Ball{document.probe_voxel(), probe.brush.radius_voxels, threshold})
                  : std::nullopt);
    document.meter.advance();
    reading_.relevant_share = document.meter.share();
}

/// Returns whether to measure the probe's share: its label is shown, no stroke runs, and brushes may have its radius.
bool Reader::probe_is_measured() const
{
    const Document& document = *document_;
    if (!document.session.interaction.probe_label || document.annotator.stroke_is_running()) return false;
    try {
        check_radius(document.brush().radius_voxels, document.volume().spacing, document.volume().size);
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// Returns whether all was read. Only voxels of a volume on another machine may still be on their way.
bool Reader::read_at(const glm::dvec3& voxel)
{
    const Document& document = *document_;
    const glm::dvec3 size(document.volume().size);
    reading_.intensity.reset();
    reading_.offset = 0.0;
    reading_.group = 0;
    reading_.is_inside =
        glm::all(glm::greaterThanEqual(voxel, glm::dvec3(0.0))) && glm::all(glm::lessThan(voxel, size));
    if (!reading_.is_inside) return true;
    const Size3 at(voxel);
    const auto& work = document.annotator.document();
    reading_.group = work.mask.at(at);
    if (work.density.voxels() > 0) reading_.offset = work.density.at(at);
    if (is_address(document.session.volume_path.string())) {
        const std::optional<DensityBox> read = far_.find(document.source, {at, at + int64_t{1}});
        if (read) reading_.intensity = read->values[0];
        return !far_.is_reading();
    }
    try {
        reading_.intensity =
            densities_in(*document.source, work.density, {at, at + int64_t{1}}).values[0] - reading_.offset;
    } catch (const Error&) {
        // Without a value, the reading is empty. The renderer reports the error when it draws the voxel.
    }
    return true;
}

void Reader::act(const MeasureAt& action)
{
    Document& document = *document_;
    const std::optional<glm::dvec3> point = others_.seen_at(others_.pane(action.pane), action.pixel);
    if (!point) decline("Nothing is seen there, so nothing is measured; click something visible");
    if (document.session.measurements.size() == MAX_MEASUREMENTS)
        decline(sentence("There are ", MAX_MEASUREMENTS,
                         " measurements, and no more are kept; copy them and remove some first"));
    const glm::dvec3 voxel = *point / document.volume().spacing;
    if (!document.measuring.empty() && document.measuring.back() == voxel)
        decline("This is the point that was clicked last; click another one");
    document.measuring.push_back(voxel);
    const MeasureKind kind = document.session.probe.measure;
    const size_t points = document.measuring.size();
    if (points < last_point_of(kind).value_or(MAX_MEASURED_POINTS)) return say(next_step(kind, points));
    complete_measurement();
}

void Reader::act(const EndMeasure&)
{
    if (document_->session.probe.measure != MeasureKind::path || document_->measuring.size() < 2)
        decline("No path with two points is begun, so none is ended");
    complete_measurement();
}

void Reader::act(const TakeBackPoint&)
{
    std::vector<glm::dvec3>& points = document_->measuring;
    const MeasureKind kind = document_->session.probe.measure;
    if (points.empty()) decline("No measurement is begun, so no point is taken back");
    points.pop_back();
    if (points.empty()) return say(sentence("The ", spelled(kind), " that was begun is dropped"));
    say("Took back a point. " + next_step(kind, points.size()));
}

void Reader::complete_measurement()
{
    Document& document = *document_;
    Session after = document.session;
    const MeasureKind kind = after.probe.measure;
    after.measurements.push_back({std::exchange(document.measuring, {}), kind, unused_name(after.measurements, kind)});
    others_.take_session(std::move(after));
    const std::vector<Measurement>& all = document.session.measurements;
    const std::string copy = keeper_.keys_of("copy_measurements"), clear = keeper_.keys_of("clear_measurements");
    say(sentence(all.back().name, ": ", value_in_words(all.back(), document.volume()),
                 copy.empty() ? "" : "; " + copy + " copies", clear.empty() ? "" : ", " + clear + " removes"));
}

void Reader::act(const RenameMeasurement& action)
{
    check_number(action.number, *document_);
    Session after = document_->session;
    after.measurements.at(action.number - 1).name = action.to;
    others_.take_session(std::move(after));
}

void Reader::act(const RemoveMeasurement& action)
{
    check_number(action.number, *document_);
    Session after = document_->session;
    const auto which = after.measurements.begin() + ptrdiff_t(action.number - 1);
    const std::string name = name_of(*which, action.number);
    after.measurements.erase(which);
    others_.take_session(std::move(after));
    say(sentence(name, " is removed; undo brings it back"));
}

void Reader::act(const ClearMeasurements&)
{
    Session after = document_->session;
    const bool is_one_begun = !std::exchange(document_->measuring, {}).empty();
    if (after.measurements.empty()) {
        if (is_one_begun) say("The measurement that was begun is dropped");
        return;
    }
    after.measurements.clear();
    others_.take_session(std::move(after));
    say("Measurements are removed; undo brings them back");
}

void Reader::act(const CopyMeasurements&)
{
    const std::vector<Measurement>& all = document_->session.measurements;
    clipboard_ = measurements_table(all, space_of(document_->volume()), Positions::physical, '\t');
    say(sentence(all.size(), all.size() == 1 ? " measurement is" : " measurements are",
                 " on the clipboard, as a table"));
}

ReadingModel Reader::model() const
{
    if (!document_) return {};
    const std::vector<glm::dvec3>& measuring = document_->measuring;
    return {.reading = reading_,
            .measurements = document_->session.measurements,
            .measuring = measuring,
            .measuring_to = measuring.empty() ? std::nullopt : std::optional(voxel_to_read())};
}

}  // namespace shvr::ui
