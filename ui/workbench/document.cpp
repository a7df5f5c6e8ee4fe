#include "ui/workbench/document.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/live/densities.h"
#include "engine/live/trace_marks.h"
#include "engine/session/kept_settings.h"
#include "engine/session/label_looks.h"
#include "engine/session/lasting_settings.h"

namespace shvr::ui {

namespace {

const char* const WINDOW_CAMERA = "window";

/// A session file is saved in place; for a volume, file or folder, the session file is put beside it.
std::filesystem::path session_path_of(const std::filesystem::path& input)
{
    if (std::filesystem::path file = session_file_of(input); !file.empty()) return file;
    std::filesystem::path beside = input.has_filename() ? input : input.parent_path();
    return beside.replace_extension(".session.json");
}

std::optional<std::string> text_of_session(const std::filesystem::path& path)
{
    constexpr int64_t LARGEST_SESSION = int64_t{16} << 20;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return std::nullopt;
    return read_text(path, LARGEST_SESSION);
}

void load(Renderer& renderer, const std::shared_ptr<const VolumeSource>& source, const VolumeStatistics& statistics,
          const Session& session)
{
    renderer.load(source, statistics, session.render, shows_occlusion(session.light));
}

}  // namespace

std::unique_ptr<Document> Document::open(Renderer& renderer, OpenedSession opened, const std::filesystem::path& input,
                                         const View::Options& view_options, const std::vector<std::string>& overridden,
                                         std::shared_ptr<Hold> hold)
{
    load(renderer, opened.source, opened.statistics, opened.session);
    std::unique_ptr<Document> document(
        new Document(renderer, std::move(opened), session_path_of(input), view_options, overridden));
    document->load_work(renderer, std::move(hold));
    document->begin_with_turning();
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
    session_text_ = text_of_session(session_path);
    surfaces = std::exchange(session.surfaces, {});
    choose_thresholds(session);
    touch.place(session.probe.voxel.value_or(0.5 * glm::dvec3(volume().size)) * volume().spacing);
}

/// Nobody who opens a scan changes it by the first drag, whatever was painted last; and older sessions state the tool
/// that paints where the right button painted. --set may still choose.
void Document::begin_with_turning()
{
    const bool is_chosen =
        std::ranges::any_of(overridden_, [](const std::string& setting) { return setting.starts_with("probe.tool="); });
    Tool& tool = session.probe.tool;
    if (!is_chosen && (tool == Tool::paint || tool == Tool::erase)) tool = Tool::turn;
}

void Document::choose_thresholds(Session& of) const
{
    ProbeSettings& probe = of.probe;
    if (!probe.brush.threshold) probe.brush.threshold = dab_of(of, volume(), statistics).threshold;
    if (!probe.haptic_threshold) probe.haptic_threshold = probe.brush.threshold;
}

void Document::load_work(Renderer& renderer, std::shared_ptr<Hold> hold)
{
    const WorkFiles files = with_kept_settings(work_files(session, volume(), overridden_), session, overridden_);
    std::vector<Notice> notices;
    try {
        notices = annotator.open(files, {.hold = std::move(hold), .program = "shvr view"});
    } catch (const JournalTaken& taken) {
        const std::optional<Holder> other = holder_of(files.journal);
        holder = other ? in_words(*other) : taken.what();
        notices = annotator.open(files, {.only_look = true});
    }
    for (Notice& notice : notices) messages.push_back(std::move(notice.text));
    set_lasting_settings(session, without_overridden(annotator.work().settings(), overridden_));
    take_kept_settings();
    choose_for_volume(session);
    annotator.work().select_trace({});  // the next node is not linked with one that nobody remembers
    renderer.scene().show_surfaces(surfaces, annotator.document().trace, session.groups);
}

/// The view and the probe come back as they were left, even where nobody could save them.
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

/// What neither the file nor the journal says. Later than both, so that it counts as no change of either.
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
    if (!only_looks()) annotator.work().keep_settings(without_overridden(kept_settings(saved_session()), overridden_));
}

void Document::show_again(Renderer& renderer)
{
    load(renderer, source, statistics, session);
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

/// What another program wrote there since is kept, and the notice tells where.
std::optional<Notice> Document::write_session()
{
    std::optional<Notice> notice;
    const std::string text = to_text(saved_session(), std::filesystem::absolute(session_path).parent_path());
    if (const std::optional<std::string> there = text_of_session(session_path); there && there != session_text_) {
        const std::filesystem::path old = set_aside(session_path);
        notice = {
            sentence(session_path.string(), ": was written by another program since it was opened; it is kept as ",
                     old.string(), ", and what is saved is this window's"),
            true};
    }
    write_file_atomically(session_path, std::as_bytes(std::span(text)));
    session_text_ = text;
    return notice;
}

void Document::keep_view()
{
    if (only_looks() || !annotator.work().disputes().empty()) return;
    const bool is_kept = saved_camera_ == camera && saved_probe_voxel_ == probe_voxel();
    std::error_code ignored;
    if (is_kept || !overridden_.empty() || !is_saved() || !std::filesystem::is_regular_file(session_path, ignored))
        return;
    try {
        write_session();
    } catch (const Error&) {  // a camera position is not worth an error message
    }
}

bool Document::record_settings()
{
    if (only_looks()) return false;
    const SettingValues now = lasting_settings(session);
    return annotator.change_settings(difference_of(annotator.work().settings(), now), now) != nullptr;
}

void Document::take_settings()
{
    set_lasting_settings(session, annotator.work().settings());
    annotator.renderer().scene().show_surfaces(surfaces, annotator.document().trace, session.groups);
    note_edit();
}

std::vector<Notice> Document::save()
{
    if (only_looks())
        throw JournalTaken(sentence(session_path.string(), ": is not saved, since the project is open for writing in ",
                                    holder, "; expected it to be closed there, or a copy to work on"));
    if (session.density_path.empty() && annotator.document().density.voxels() > 0)
        session.density_path = std::filesystem::path(session.mask_path).replace_extension(".offset");
    name_trace();
    annotator.work().name_files(session.mask_path, session.trace_path, session.density_path);
    keep_settings();
    std::optional<Notice> session_notice;
    std::vector<Notice> notices =
        annotator.work()
            .save(label_looks(session.groups, annotator.document().mask), [&] { session_notice = write_session(); })
            .notices;
    if (session_notice) notices.push_back(std::move(*session_notice));
    note_saved();
    return notices;
}

void Document::save_settings()
{
    if (edits_are_saved() || !overridden_.empty()) return;
    static_cast<void>(write_session());
    note_saved();
}

namespace {

std::filesystem::path beside(const std::filesystem::path& session_file, const char* extension)
{
    return std::filesystem::path(session_file).replace_extension(extension);
}

/// The session under another name, with files of that name.
Session renamed(Session session, const std::filesystem::path& path)
{
    session.mask_path = beside(path, ".mask");
    session.trace_path = beside(path, ".graphml");
    session.density_path = beside(path, ".offset");
    session.journal_path = journal_beside(path);
    return session;
}

/// Fails where it is no name of a session, or taken.
std::filesystem::path new_session_path(const std::filesystem::path& path)
{
    if (path.extension() != ".json") fail(path.string(), ": is no name for a session; expected one that ends in .json");
    for (const char* extension : {".json", ".mask", ".graphml", ".offset", ".journal"})
        if (is_there(beside(path, extension)))
            fail(beside(path, extension).string(), ": exists already; expected a name that is free");
    return std::filesystem::absolute(path).lexically_normal();
}

std::filesystem::path free_copy_path(const std::filesystem::path& session_file)
{
    const std::string stem = beside(session_file, "").string() + "-copy";
    for (int number = 1;; ++number) {
        const std::filesystem::path path = number == 1 ? stem + ".json" : sentence(stem, number, ".json");
        const auto is_taken = [&](const char* extension) { return is_there(beside(path, extension)); };
        if (std::ranges::none_of(std::array{".json", ".mask", ".graphml", ".offset", ".journal"}, is_taken))
            return path;
    }
}

}  // namespace

std::filesystem::path Document::save_copy(const std::filesystem::path& path) const
{
    const std::filesystem::path copy = path.empty() ? free_copy_path(session_path) : new_session_path(path);
    const Session copied = renamed(saved_session(), copy);
    annotator.work().save_copy(work_files(copied, volume()), label_looks(session.groups, annotator.document().mask));
    const std::string text = to_text(copied, std::filesystem::absolute(copy).parent_path());
    write_file_atomically(copy, std::as_bytes(std::span(text)));
    return copy;
}

std::vector<Notice> Document::save_as(const std::filesystem::path& path)
{
    const std::filesystem::path next = new_session_path(path);
    keep_settings();
    const Session moved = renamed(saved_session(), next);
    const std::string text = to_text(moved, next.parent_path());
    std::vector<Notice> notices =
        annotator.work()
            .save_as(work_files(moved, volume()), label_looks(session.groups, annotator.document().mask), next,
                     [&] { write_file_atomically(next, std::as_bytes(std::span(text))); })
            .notices;
    session = renamed(std::move(session), next);
    session_path = next;
    session_text_ = text;
    overridden_.clear();  // what was set for this time only is in the new file
    note_saved();
    return notices;
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
    BrushSettings used = brush();
    used.group = session.probe.painted_group();
    return in_session(stroke_of(used, *used.threshold), session);
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
            .radius_voxels = session.probe.node_radius_voxels.value_or(brush().radius_voxels),
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

bool Document::is_cut() const
{
    const TraceGraph& trace = annotator.document().trace;
    return cut_ends && trace.nodes().contains(cut_ends->first) && trace.nodes().contains(cut_ends->second) &&
           !trace.internode_between(cut_ends->first, cut_ends->second);
}

std::optional<double> Document::measured_radius(const glm::dvec3& voxel) const
{
    constexpr double MOST_VOXELS =
        24.0;  // along the finest axis; the box that is read is twice as far in each direction
    const VolumeInfo& info = volume();
    const double finest = std::min({info.spacing.x, info.spacing.y, info.spacing.z});
    const glm::dvec3 size(info.size), reach = 2.0 * MOST_VOXELS * finest / info.spacing + 2.0;
    if (glm::any(glm::lessThan(voxel, glm::dvec3(0.0))) || glm::any(glm::greaterThan(voxel, size))) return {};
    const VoxelBox box{Size3(glm::clamp(glm::floor(voxel - reach), glm::dvec3(0.0), size - 1.0)),
                       Size3(glm::clamp(glm::ceil(voxel + reach), glm::dvec3(1.0), size))};
    const DensityBox densities = densities_in(*source, annotator.document().density, box);
    const auto radius = local_radius([&](const glm::dvec3& at) { return densities.at(at); }, *brush().threshold, voxel,
                                     info.spacing, MOST_VOXELS * finest);
    return radius ? std::optional(*radius / info.spacing.x) : std::nullopt;
}

TraceMarks Document::trace_marks() const
{
    if (!session.view.meshes) return {};
    const glm::dvec3& spacing = volume().spacing;
    const double least = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
    return shvr::trace_marks(annotator.document().trace,
                             session.probe.tool == Tool::trace ? nearby_node() : std::nullopt, least,
                             drags_node ? std::optional(touch.probe()) : std::nullopt);
}

}  // namespace shvr::ui
