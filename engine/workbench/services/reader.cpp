#include "engine/workbench/services/reader.h"

#include <cmath>

#include "engine/live/densities.h"
#include "engine/remote/address.h"
#include "engine/workbench/desk/declined.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

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

// ---- Measuring ------------------------------------------------------------------------------------------------------

void Reader::act(const MeasureAt& action)
{
    Document& document = *document_;
    const std::optional<glm::dvec3> point = others_.seen_at(others_.pane(action.pane), action.pixel);
    if (!point) decline("Nothing is seen there, so nothing is measured; click something visible");
    const glm::dvec3 voxel = *point / document.volume().spacing;
    if (!document.measuring_from) {
        document.measuring_from = voxel;
        return say("One end of the distance; click the other");
    }
    Session after = document.session;
    if (after.measurements.size() == MAX_MEASUREMENTS)
        fail(MAX_MEASUREMENTS, " distances are measured, and no more are kept; expected them to be copied and removed");
    after.measurements.push_back({*document.measuring_from, voxel});
    document.measuring_from.reset();
    others_.take_session(std::move(after));
    const std::vector<Measurement>& all = document.session.measurements;
    const double length = length_of(all.back(), document.volume().spacing);
    const std::string copy = keeper_.keys_of("copy_measurements"), clear = keeper_.keys_of("clear_measurements");
    say(sentence("Distance ", all.size(), ": ", length_in_words(length, document.volume().unit),
                 copy.empty() ? "" : "; " + copy + " copies", clear.empty() ? "" : ", " + clear + " removes"));
}

void Reader::act(const ClearMeasurements&)
{
    Session after = document_->session;
    const bool is_one_begun = std::exchange(document_->measuring_from, {}).has_value();
    if (after.measurements.empty()) {
        if (is_one_begun) say("The begun distance is dropped");
        return;
    }
    after.measurements.clear();
    others_.take_session(std::move(after));
    say("Distances are removed; undo brings them back");
}

void Reader::act(const CopyMeasurements&)
{
    const std::vector<Measurement>& all = document_->session.measurements;
    clipboard_ = table_of(all, document_->volume());
    say(sentence(all.size(), all.size() == 1 ? " distance is" : " distances are", " on the clipboard, as a table"));
}

ReadingModel Reader::model() const
{
    if (!document_) return {};
    const std::optional<glm::dvec3>& from = document_->measuring_from;
    return {.reading = reading_,
            .measurements = document_->session.measurements,
            .measuring_from = from,
            .measuring_to = from ? std::optional(voxel_to_read()) : std::nullopt};
}

}  // namespace shvr::ui
