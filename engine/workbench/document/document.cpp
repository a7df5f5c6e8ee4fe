#include "engine/workbench/document/document.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/live/densities.h"
#include "engine/live/trace_marks.h"
#include "engine/remote/address.h"
#include "engine/session/annotation_files.h"
#include "engine/session/kept_settings.h"
#include "engine/session/label_looks.h"
#include "engine/session/lasting_settings.h"
#include "engine/session/words/setting_words.h"
#include "engine/workbench/document/savable.h"
#include "engine/workbench/touch/felt_relevance.h"

namespace shvr::ui {

namespace {

const char* const WINDOW_CAMERA = "window";

}  // namespace

std::filesystem::path session_path_of(const std::filesystem::path& input)
{
    if (std::filesystem::path file = session_file_of(input); !file.empty()) return file;
    std::filesystem::path beside = input.has_filename() ? input : input.parent_path();
    return beside.replace_extension(".session.json");
}

std::optional<std::string> text_of_session(const std::filesystem::path& path)
{
    constexpr int64_t MAX_SESSION_BYTES = int64_t{16} << 20;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return std::nullopt;
    return read_text(path, MAX_SESSION_BYTES);
}

/// A volume at an address has no work, and nothing is kept of it: neither a session nor a journal. Screenshots are
/// written into the current folder.
Document::Read Document::read_remote(OpenedSession opened, const std::filesystem::path& address,
                                     const std::vector<std::string>& overridden)
{
    Session& session = opened.session;
    const VolumeInfo& volume = opened.source->info();
    std::error_code ignored;
    const std::filesystem::path folder = std::filesystem::current_path(ignored);
    const std::filesystem::path named = address.has_filename() ? address : address.parent_path();
    shvr::choose_thresholds(session, volume, opened.statistics);
    Read read{.opened = {},
              .session_path = (folder / named.filename()).replace_extension(".session.json"),
              .overridden = overridden,
              .work = std::make_unique<Work>(volume.size, volume.type),
              .remote = address.string()};
    constexpr const char* FAR =
        "The scan is read only, since it lies on another machine; Import as project, above the "
        "picture, makes a copy that can be changed";
    read.notices = read.work->open(work_files(session, volume, overridden),
                                   {.only_look = true, .why_only_look = FAR, .program = {}});
    read.opened = std::move(opened);
    return read;
}

Document::Read Document::read(OpenedSession opened, const std::filesystem::path& input,
                              const std::vector<std::string>& overridden, Work::Opening opening, bool may_write_outside)
{
    if (leads_to_network(input)) return read_remote(std::move(opened), input, overridden);
    Session& session = opened.session;
    const VolumeInfo& volume = opened.source->info();
    const std::filesystem::path path = session_path_of(input);
    if (session.mask_path.empty()) session.mask_path = mask_beside(path);
    if (session.journal_path.empty()) session.journal_path = journal_beside(path);
    shvr::choose_thresholds(session, volume, opened.statistics);
    Read read{.opened = {}, .session_path = path, .overridden = overridden, .work = nullptr};
    read.session_text = text_of_session(path);
    const WorkFiles files = with_kept_settings(work_files(session, volume, overridden), session, overridden);
    const auto open_work = [&](const Work::Opening& how) {
        read.work = std::make_unique<Work>(volume.size, volume.type);
        read.notices = read.work->open(files, how);
    };
    if (!may_write_outside) read.outside = files_outside(session, path, overridden);
    if (!read.outside.empty()) {
        opening.only_look = true;
        opening.why_only_look =
            sentence("The scan is read only, since its session writes outside its folder: ", read.outside,
                     "; choose Write there or Work on a copy, above the picture");
        opening.hold.reset();
    }
    try {
        open_work(opening);
    } catch (const JournalTaken& taken) {
        const std::optional<Holder> other = holder_of(files.journal);
        read.holder = other ? in_words(*other) : taken.what();
        opening.only_look = true;
        opening.why_only_look = sentence("The scan is read only, since it is open for writing in ", read.holder,
                                         "; close it there and choose Try again, or choose Work on a copy, above the "
                                         "picture");
        opening.hold.reset();
        open_work(opening);
    }
    if (!read.work->only_looks()) read.unsavable = why_not_savable(path);
    read.opened = std::move(opened);
    return read;
}

Document::Document(Renderer& renderer, Read read, const View::Options& view_options)
    : session_path(std::move(read.session_path)),
      session(std::move(read.opened.session)),
      source(std::move(read.opened.source)),
      scene_source(source),
      statistics(read.opened.statistics),
      camera(camera_named(session, session.camera_name, source->info())),
      annotator(renderer, std::move(read.work)),
      screen(renderer, view_options),
      touch(renderer),
      messages(std::move(read.notices)),
      holder(std::move(read.holder)),
      outside(std::move(read.outside)),
      remote(std::move(read.remote)),
      unsavable(std::move(read.unsavable)),
      is_script_(read.is_script),
      overridden_(std::move(read.overridden)),
      session_text_(std::move(read.session_text))
{
    surfaces = std::exchange(session.surfaces, {});
    touch.place(session.probe.voxel.value_or(0.5 * glm::dvec3(volume().size)) * volume().spacing);
    set_lasting_settings(session, without_overridden(annotator.work().settings(), overridden_));
    take_kept_settings();
    choose_for_volume(session);
    begin_with_turning();
    if (!is_script_) annotator.work().select_trace({});  // the next node is not linked with a node of earlier work
    show_again(renderer);
    note_saved();
}

/// Selects a harmless tool, so that the first drag in an opened scan changes nothing, whatever tool was used last.
/// Sessions of older versions, in which the right button painted, state the paint tool, too. --set may still choose it.
void Document::begin_with_turning()
{
    const bool is_chosen =
        std::ranges::any_of(overridden_, [](const std::string& setting) { return setting.starts_with("probe.tool="); });
    Tool& tool = session.probe.tool;
    if (!is_chosen && (tool == Tool::paint || tool == Tool::erase)) tool = Tool::turn;
}

void Document::choose_thresholds(Session& of) const
{
    shvr::choose_thresholds(of, volume(), statistics);
}

/// Restores the last view and probe position from the journal, in case the session file could not be written.
void Document::take_kept_settings()
{
    const SettingValues kept = without_overridden(annotator.work().kept_settings(), overridden_);
    if (kept.empty()) return;
    set_kept_settings(session, kept);
    camera = camera_named(session, session.camera_name, volume());
    ProbeSettings& probe = session.probe;
    choose_thresholds(session);
    if (probe.voxel) touch.place(*probe.voxel * volume().spacing);
}

/// Chooses settings that neither the session file nor the journal states. Call it once both are read; changes neither.
void Document::choose_for_volume(Session& of) const
{
    if (!of.probe.node_radius_voxels) of.probe.node_radius_voxels = automatic_node_radius(volume());
    SliceSettings& slices = of.view.slices;
    if (slices.black || slices.white) return;
    const ValueRange contrast = automatic_contrast(statistics);
    slices.black = contrast.lower;
    slices.white = contrast.upper;
}

void Document::keep_settings()
{
    if (!only_looks() && !is_script_)
        annotator.work().keep_settings(without_overridden(kept_settings(saved_session()), overridden_));
}

void Document::load_again(Renderer& renderer)
{
    renderer.load(scene_source, statistics, session.render, shows_occlusion(session.light));
    show_again(renderer);
}

void Document::show_again(Renderer& renderer)
{
    renderer.scene().read_in_background(!is_script_ && leads_to_network(session.volume_path));
    renderer.scene().show(annotator.document());
    renderer.scene().show_surfaces(surfaces, annotator.document().trace, session.groups);
}

ProbeLook Document::probe_look() const
{
    ProbeLook look{.center = touch.probe(),
                   .radius = probe_radius(),
                   .color = probe_color(session, session.probe.painted_group())};
    look.ball_opacity = session.probe.opacity;
    look.has_silhouette = session.probe.silhouette;
    look.has_arrow = session.probe.arrow;
    // With its outline, the probe is a ring around a point, through which its target is seen.
    if (look.has_silhouette || painted_at == touch.probe()) look.ball_share = BALL_IN_SHELL;
    if (previewer.shown()) {
        look.ball_share = BALL_IN_SHELL;
        look.preview = previewer.shown();
    }
    if (operation_preview) look.preview = operation_preview;
    if (session.probe.shell) {
        look.ball_share = BALL_IN_SHELL;
        look.shell = ShellLook{.threshold = *brush().threshold,
                               .opacity = session.probe.shell_opacity,
                               .is_box = brush().region == RegionShape::box};
    }
    return look;
}

FeltLimits Document::felt_limits() const
{
    return ui::felt_limits(session, camera, volume(), window_for(volume().type, statistics));
}

ToolPlace Document::tool_place_at(const glm::dvec3& point) const
{
    if (drags_node) return {point, {}, {}};
    const TraceGraph& trace = annotator.document().trace;
    const bool is_brush = session.probe.tool == Tool::paint || session.probe.tool == Tool::erase;
    const FeelSettings& feel = session.probe.touch;
    std::bitset<256> drawn;
    if (!feel.to_nodes && !feel.to_lines) return {point, {}, {}};
    if (feel.feels_hidden)
        drawn.set();
    else if (session.view.meshes)
        drawn = drawn_groups(session.shown_groups(), false);
    return ui::tool_place(feel, trace, point, probe_radius(), is_brush ? std::nullopt : trace.selection().node(),
                          drawn);
}

ToolPlace Document::tool_place() const
{
    ToolPlace place = tool_place_at(touch.probe());
    if (place.node || place.internode) return place;
    const ServoState* const servo = touch.servo();
    const bool has_middle = session.probe.touch.at_proxy && servo && servo->ticks > 0 && servo->step.in_contact;
    if (has_middle) place.point = servo->step.middle;
    return place;
}

VoxelBox Document::voxels_around_probe() const
{
    const glm::dvec3 size(volume().size), reach = probe_radius() / volume().spacing;
    const glm::dvec3 lower = glm::clamp(glm::floor(probe_voxel() - reach), glm::dvec3(0.0), size - 1.0);
    const glm::dvec3 upper = glm::clamp(glm::ceil(probe_voxel() + reach), lower + 1.0, size);
    return {Size3(lower), Size3(upper)};
}

Document::Place Document::place() const
{
    const SliceSettings& slices = session.view.slices;
    return {camera, probe_voxel(), slices.zoom, slices.center, slices.cross};
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

/// Returns the settings as they would be saved, without surfaces, which can be many and never change here.
Session Document::edits() const
{
    Session edits = saved_session();
    edits.surfaces.clear();
    edits.cameras = session.cameras;
    edits.camera_name = session.camera_name;
    edits.probe.voxel.reset();
    edits.view.slices.zoom = 1.0;
    edits.view.slices.center.reset();
    edits.view.slices.cross.reset();
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
    saved_place_ = place();
}

bool Document::record_settings(const std::string& label)
{
    if (only_looks() || is_script_) return false;
    const SettingValues now = lasting_settings(session);
    return annotator.change_settings(label.empty() ? difference_of(annotator.work().settings(), now) : label, now) !=
           nullptr;
}

bool Document::record_sections(std::initializer_list<std::string_view> names)
{
    if (only_looks()) return false;
    const auto is_other = [&](const auto& section) { return std::ranges::find(names, section.first) == names.end(); };
    SettingValues before = annotator.work().settings(), now = lasting_settings(session);
    std::erase_if(before, is_other);
    std::erase_if(now, is_other);
    return annotator.change_settings(difference_of(before, now), now) != nullptr;
}

void Document::take_settings()
{
    set_lasting_settings(session, annotator.work().settings());
    annotator.renderer().scene().show_surfaces(surfaces, annotator.document().trace, session.groups);
    note_edit();
}

PaintOp Document::stroke() const
{
    BrushSettings used = brush();
    used.group = session.probe.painted_group();
    return in_session(stroke_of(used, *used.threshold), session);
}

PaintOp Document::dab() const
{
    PaintOp dab = stroke();
    dab.path = {tool_voxel()};
    return dab;
}

TraceDefaults Document::trace_defaults() const
{
    return {.spacing = volume().spacing,
            .radius_voxels =
                is_script_ ? brush().radius_voxels : session.probe.node_radius_voxels.value_or(brush().radius_voxels),
            .group = brush().group,
            .size = volume().size,
            .found = is_script_ ? EVERY_GROUP : groups_found_nearby(session)};
}

std::optional<uint32_t> Document::nearby_node() const
{
    const TraceGraph& trace = annotator.document().trace;
    return nearest_node_of(trace, groups_found_nearby(session), touch.probe(), NEARBY_RADII * probe_radius(),
                           trace.selection().node());
}

bool Document::is_cut() const
{
    const TraceGraph& trace = annotator.document().trace;
    return cut_ends && trace.nodes().contains(cut_ends->first) && trace.nodes().contains(cut_ends->second) &&
           !trace.internode_between(cut_ends->first, cut_ends->second);
}

/// Returns intensities with density offsets. From another machine: only what was read; otherwise starts to read it.
DensityBox Document::densities_at_once(const VoxelBox& box)
{
    const DensityField& offsets = annotator.document().density;
    if (!is_address(session.volume_path.string())) return densities_in(*source, offsets, box);
    std::optional<DensityBox> read = far_.find(source, box);
    if (!read && far_.is_reading())
        fail("the voxels there are still being read from another machine; expected them in a moment: try again then");
    if (!read) fail("the voxels there cannot be read from ", session.volume_path.string());
    add_offsets(offsets, box, *read);
    return *std::move(read);
}

std::optional<LocalBall> Document::ball_at(const glm::dvec3& voxel, const std::optional<glm::dvec3>& way)
{
    const VolumeInfo& info = volume();
    const double finest = std::min({info.spacing.x, info.spacing.y, info.spacing.z});
    const glm::dvec3 size(info.size), ahead = way ? glm::normalize(*way) : glm::dvec3(0.0);
    if (glm::any(glm::lessThan(voxel, glm::dvec3(0.0))) || glm::any(glm::greaterThan(voxel, size))) return {};
    // Tries small sizes first, since most structures are thin, and small sizes read few voxels.
    for (const double most_voxels : {6.0, 12.0, 24.0}) {  // along the finest axis
        const double most = most_voxels * finest;
        // The centre is within `most` of the voxel, or of a point up to `most` behind it. The radius is at most `most`.
        const glm::dvec3 about = voxel + 0.5 * most * ahead / info.spacing;
        const glm::dvec3 reach = (way ? 2.5 : 2.0) * most / info.spacing + 2.0;
        const VoxelBox box{Size3(glm::clamp(glm::floor(about - reach), glm::dvec3(0.0), size - 1.0)),
                           Size3(glm::clamp(glm::ceil(about + reach), glm::dvec3(1.0), size))};
        const DensityBox densities = densities_at_once(box);
        const auto density_at = [&](const glm::dvec3& at) { return densities.at(at); };
        const auto found =
            way ? ball_behind(density_at, *brush().threshold, voxel, *way, info.spacing, most, probe_radius())
                : local_ball(density_at, *brush().threshold, voxel, info.spacing, most);
        if (found) return found;
    }
    return {};
}

TraceMarks Document::trace_marks() const
{
    if (!session.view.meshes) return {};
    const glm::dvec3& spacing = volume().spacing;
    const double least = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
    const bool is_traced = session.probe.tool == Tool::trace;
    constexpr size_t SHOWN_LINKS = 64;  // about what fits on a screen
    const TraceGraph& trace = annotator.document().trace;
    std::optional<glm::dvec3> moved_by;
    if (drags_node) {
        const MoveOp move = drag_move();
        const std::optional<uint32_t> node = trace.selection().node();
        const glm::dvec3 to = move.to * spacing;
        moved_by = to - (move.from ? *move.from * spacing : node ? trace.node(*node).position : to);
    }
    return shvr::trace_marks(trace, is_traced ? nearby_node() : std::nullopt, least, moved_by,
                             is_traced ? SHOWN_LINKS : 0);
}

MoveOp Document::drag_move() const
{
    MoveOp move{.to = tool_voxel()};
    if (!annotator.document().trace.selection().node()) move.from = drag_from;
    return move;
}

}  // namespace shvr::ui
