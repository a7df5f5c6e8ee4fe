#include "ui/document.h"

#include <algorithm>
#include <utility>

#include "engine/base/atomic_file.h"
#include "engine/live/trace_marks.h"
#include "engine/session/label_looks.h"
#include "engine/session/lasting_settings.h"

namespace shvr::ui {

namespace {

const char* const WINDOW_CAMERA = "window";

/// A session file is saved in place; for a volume, file or folder, the session file is put beside it.
std::filesystem::path session_path_of(const std::filesystem::path& input)
{
    std::filesystem::path of_project = input / "shvr" / "session.json";
    if (std::filesystem::exists(of_project)) return of_project;
    if (input.extension() == ".json") return input;
    std::filesystem::path beside = input.has_filename() ? input : input.parent_path();
    return beside.replace_extension(".session.json");
}

void load(Renderer& renderer, const std::shared_ptr<const VolumeSource>& source, const VolumeStatistics& statistics,
          const Session& session)
{
    renderer.load(source, statistics, session.render, shows_occlusion(session.light));
}

}  // namespace

std::unique_ptr<Document> Document::open(Renderer& renderer, OpenedSession opened, const std::filesystem::path& input,
                                         const View::Options& view_options, const std::vector<std::string>& overridden)
{
    load(renderer, opened.source, opened.statistics, opened.session);
    std::unique_ptr<Document> document(
        new Document(renderer, std::move(opened), session_path_of(input), view_options, overridden));
    document->load_work(renderer);
    document->note_saved();
    return document;
}

Document::Document(Renderer& renderer, OpenedSession opened, const std::filesystem::path& path,
                   const View::Options& view_options, const std::vector<std::string>& overridden)
    : session_path(path),
      session(std::move(opened.session)),
      source(std::move(opened.source)),
      statistics(opened.statistics),
      camera(camera_named(session, session.camera_name, source->info())),
      annotator(renderer),
      screen(renderer, view_options),
      touch(renderer),
      overridden_(overridden)
{
    if (session.mask_path.empty()) {
        session.mask_path = session_path;
        session.mask_path.replace_extension(".mask");
    }
    if (session.journal_path.empty()) session.journal_path = journal_beside(session_path);
    surfaces = std::exchange(session.surfaces, {});
    ProbeSettings& probe = session.probe;
    probe.brush.threshold = dab_of(session, volume(), statistics).threshold;
    if (!probe.haptic_threshold) probe.haptic_threshold = probe.brush.threshold;
    touch.place(probe.voxel.value_or(0.5 * glm::dvec3(volume().size)) * volume().spacing);
}

void Document::load_work(Renderer& renderer)
{
    messages = annotator.open(work_files(session, volume(), overridden_));
    set_lasting_settings(session, without_overridden(annotator.work().settings(), overridden_));
    renderer.scene().show_surfaces(surfaces, annotator.document().trace, session.groups);
}

void Document::show_again(Renderer& renderer)
{
    load(renderer, source, statistics, session);
    renderer.scene().show(annotator.document());
    renderer.scene().show_surfaces(surfaces, annotator.document().trace, session.groups);
}

ProbeLook Document::probe_look() const
{
    ProbeLook look{.center = touch.probe(), .radius = probe_radius(), .color = probe_color(session, brush().group)};
    if (previewer.shown()) {
        look.ball_share = BALL_IN_SHELL;
        look.preview = previewer.shown();
    }
    if (session.probe.shell) {
        look.ball_share = BALL_IN_SHELL;
        look.shell = ShellLook{.threshold = *brush().threshold,
                               .opacity = session.probe.shell_opacity,
                               .is_box = brush().region == RegionShape::box};
    }
    return look;
}

VoxelBox Document::voxels_around_probe() const
{
    const glm::dvec3 size(volume().size), reach = probe_radius() / volume().spacing;
    const glm::dvec3 lower = glm::clamp(glm::floor(probe_voxel() - reach), glm::dvec3(0.0), size - 1.0);
    const glm::dvec3 upper = glm::clamp(glm::ceil(probe_voxel() + reach), lower + 1.0, size);
    return {Size3(lower), Size3(upper)};
}

Session Document::saved_session() const
{
    Session saved = session;
    saved.surfaces = surfaces;
    saved.cameras[WINDOW_CAMERA] = camera;
    saved.camera_name = WINDOW_CAMERA;
    saved.probe.voxel = probe_voxel();
    return saved;
}

// ---- Saving ---------------------------------------------------------------------------------------------------------

/// The user's settings, as they would be written. Surfaces are left out: nothing here changes them, and there are many.
Session Document::edits() const
{
    Session edits = saved_session();
    edits.surfaces.clear();
    edits.cameras = session.cameras;
    edits.camera_name = session.camera_name;
    edits.probe.voxel.reset();
    return edits;
}

bool Document::edits_are_saved() const
{
    if (!edits_are_saved_) edits_are_saved_ = edits() == saved_edits_;
    return *edits_are_saved_;
}

void Document::note_saved()
{
    saved_edits_ = edits();
    edits_are_saved_ = true;
    saved_camera_ = camera;
    saved_probe_voxel_ = probe_voxel();
}

void Document::write_session() const
{
    const std::string text = to_text(saved_session(), std::filesystem::absolute(session_path).parent_path());
    write_file_atomically(session_path, std::as_bytes(std::span(text)));
}

void Document::keep_view() const
{
    const bool is_kept = saved_camera_ == camera && saved_probe_voxel_ == probe_voxel();
    std::error_code ignored;
    if (is_kept || !overridden_.empty() || !is_saved() || !std::filesystem::is_regular_file(session_path, ignored))
        return;
    try {
        write_session();
    } catch (const Error&) {  // a camera position is not worth an error message
    }
}

void Document::record_settings()
{
    const SettingValues now = lasting_settings(session);
    annotator.change_settings(difference_of(annotator.work().settings(), now), now);
}

void Document::take_settings()
{
    set_lasting_settings(session, annotator.work().settings());
    annotator.renderer().scene().show_surfaces(surfaces, annotator.document().trace, session.groups);
    note_edit();
}

void Document::save()
{
    if (session.density_path.empty() && annotator.document().density.voxels() > 0)
        session.density_path = std::filesystem::path(session.mask_path).replace_extension(".offset");
    name_trace();
    annotator.work().name_files(session.mask_path, session.trace_path, session.density_path);
    annotator.work().save(label_looks(session.groups, annotator.document().mask), [this] { write_session(); });
    note_saved();
}

/// Only GraphML keeps all of a trace, so a trace from another format is saved to a new file and its source is left
/// unchanged.
void Document::name_trace()
{
    if (annotator.work().trace_is_saved()) return;
    if (session.trace_path.empty()) {
        session.trace_path = session_path;
        session.trace_path.replace_extension(".graphml");
    } else if (session.trace_path.extension() != ".graphml") {
        const std::filesystem::path stem = std::filesystem::path(session.trace_path).replace_extension();
        session.trace_path = stem.string() + ".graphml";
        for (int number = 2; std::filesystem::exists(session.trace_path); ++number)
            session.trace_path = sentence(stem.string(), "-", number, ".graphml");
    }
}

PaintOp Document::stroke() const
{
    return with_offset(stroke_of(brush(), *brush().threshold), session.transfer_function);
}

PaintOp Document::dab() const
{
    PaintOp dab = stroke();
    dab.path = {probe_voxel()};
    return dab;
}

TraceDefaults Document::trace_defaults() const
{
    return {.spacing = volume().spacing,
            .radius_voxels = brush().radius_voxels,
            .group = brush().group,
            .size = volume().size};
}

std::optional<uint32_t> Document::nearby_node() const
{
    const TraceGraph& trace = annotator.document().trace;
    const std::optional<uint32_t> nearest = trace.nearest_node(touch.probe(), trace.selection().node());
    if (!nearest || glm::distance(trace.node(*nearest).position, touch.probe()) > NEARBY_RADII * probe_radius())
        return std::nullopt;
    return nearest;
}

TraceMarks Document::trace_marks() const
{
    const glm::dvec3& spacing = volume().spacing;
    const double least = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
    return shvr::trace_marks(annotator.document().trace, tool == Tool::trace ? nearby_node() : std::nullopt, least,
                             drags_node ? std::optional(touch.probe()) : std::nullopt);
}

std::vector<std::string> Document::cameras() const
{
    std::vector<std::string> names;
    for (const auto& [name, camera_spec] : session.cameras) names.push_back(name);
    for (const std::string& side : camera_sides())
        if (std::ranges::find(names, side) == names.end()) names.push_back(side);
    return names;
}

}  // namespace shvr::ui
