#pragma once
// All services of the workbench, and the calls between them. They are destroyed in reverse order, before the desk that
// they share.

#include <tuple>

#include "engine/workbench/desk/look_shelf.h"
#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/preset_shelf.h"
#include "engine/workbench/desk/window_state.h"
#include "engine/workbench/services/file_taker.h"
#include "engine/workbench/services/hand.h"
#include "engine/workbench/services/meshes/mesh_shower.h"
#include "engine/workbench/services/opener.h"
#include "engine/workbench/services/operations/group_editor.h"
#include "engine/workbench/services/painter.h"
#include "engine/workbench/services/photographer.h"
#include "engine/workbench/services/prober.h"
#include "engine/workbench/services/reader.h"
#include "engine/workbench/services/reloader.h"
#include "engine/workbench/services/saver.h"
#include "engine/workbench/services/settings_editor.h"
#include "engine/workbench/services/task_runner.h"
#include "engine/workbench/services/tracer.h"
#include "engine/workbench/services/viewer.h"

namespace shvr::ui {

struct Services {
    explicit Services(Desk& with) : desk(with) {}

    Desk& desk;
    PreferenceKeeper keeper{desk};
    PresetShelf presets{desk};
    LookShelf looks{desk,
                    {.take_session = [this](Session session) { settings.take_session(std::move(session)); },
                     .record_settings = [this](const std::string& label) { settings.record_settings(label); }}};
    WindowState window{desk, keeper};
    Photographer photographer{
        desk, {.pixels = [this] { return viewer.pixels(); }, .stay_open = [this] { saver.stay_open(); }}};
    Viewer viewer{desk,
                  {.note_edit = [this] { settings.note_edit(); },
                   .note_to_keep = [this] { settings.note_to_keep(); },
                   .take_session = [this](Session session) { settings.take_session(std::move(session)); }}};
    SettingsEditor settings{desk,
                            {.look_again = [this] { viewer.look_again(); },
                             .show_cut_box = [this] { viewer.show_cut_box(); },
                             .stop_drag = [this] { tracer.act(DragNode{false}); },
                             .finish_stroke = [this] { return painter.finish_stroke(); },
                             .reload = [this](const RenderSettings& before) { reloader.want(before); }}};
    Reader reader{desk,
                  keeper,
                  {.pointer = [this] { return viewer.pointer(); },
                   .pane = [this](size_t index) { return viewer.pane(index); },
                   .seen_at = [this](const Pane& pane, const glm::dvec2& at) { return viewer.seen_at(pane, at); },
                   .take_session = [this](Session session) { settings.take_session(std::move(session)); }}};
    Painter painter{desk,
                    keeper,
                    {.has_settings_to_record = [this] { return settings.has_settings_to_record(); },
                     .record_settings = [this] { settings.record_settings(); },
                     .note_edit = [this] { settings.note_edit(); },
                     .note_stroke = [this](bool is_empty) { settings.note_stroke(is_empty); },
                     .stop_drag = [this] { tracer.act(DragNode{false}); },
                     .add_node_here = [this] { tracer.add_node_here(); }}};
    Prober prober{desk,
                  {.pane = [this](size_t index) { return viewer.pane(index); },
                   .seen_at = [this](const Pane& pane, const glm::dvec2& at) { return viewer.seen_at(pane, at); },
                   .seen_near = [this](const Pane& pane, const glm::dvec2& at, double depth,
                                       double reach) { return viewer.seen_near(pane, at, depth, reach); },
                   .extend_stroke = [this] { painter.extend_stroke(); },
                   .note_edit = [this] { settings.note_edit(); },
                   .note_to_keep = [this] { settings.note_to_keep(); }}};
    GroupEditor groups{desk,
                       {.record_settings = [this] { settings.record_settings(); },
                        .show_changes = [this](const Command& command) { settings.show_changes(command); },
                        .advance_jobs = [this] { tasks.advance(); }}};
    Tracer tracer{desk,
                  keeper,
                  {.pane = [this](size_t index) { return viewer.pane(index); },
                   .seen_at = [this](const Pane& pane, const glm::dvec2& at) { return viewer.seen_at(pane, at); },
                   .look_from = [this](const Camera& camera) { viewer.look_from(camera); },
                   .move_probe = [this](const glm::dvec3& point, bool jumps) { prober.move_probe(point, jumps); },
                   .set = [this](const Set& change) { settings.act(change); },
                   .record_settings = [this] { settings.record_settings(); },
                   .show_changes = [this](const Command& command) { settings.show_changes(command); }}};
    FileTaker taker{desk,
                    {.allow_outside = [this](const std::filesystem::path& path) { opener.allow_outside(path); },
                     .begin_open = [this](const std::filesystem::path& path, const std::vector<std::string>& set,
                                          std::vector<std::filesystem::path> taken_into_it,
                                          bool asks) { opener.begin_open(path, set, std::move(taken_into_it), asks); },
                     .take_session = [this](Session session) { settings.take_session(std::move(session)); },
                     .set = [this](const Set& change) { settings.act(change); },
                     .record_settings = [this] { settings.record_settings(); },
                     .show_changes = [this](const Command& command) { settings.show_changes(command); }}};
    Opener opener{desk,
                  keeper,
                  {.advance_jobs = [this] { tasks.advance(); },
                   .leave = [this](std::string& why) { return saver.leave(why); },
                   .is_saving = [this] { return saver.is_saving(); },
                   .cancel_reload = [this] { return reloader.cancel(); },
                   .drop_screenshot = [this](const char* by) { photographer.drop_large(by); },
                   .look_again = [this] { viewer.look_again(); },
                   .look_from = [this](const Camera& camera) { viewer.look_from(camera); },
                   .load_annotation = [this](const LoadAnnotation& file) { taker.act(file); },
                   .ask_what_it_is = [this](UnclearFile file) { taker.ask_what_it_is(std::move(file)); },
                   .record_settings = [this] { settings.record_settings(); },
                   .begin_document =
                       [this] {
                           reader.begin_document();
                           settings.begin_document();
                           saver.begin_document();
                           painter.begin_document();
                       }}};
    Reloader reloader{desk,
                      {.is_opening = [this] { return opener.is_opening(); },
                       .opening_name = [this] { return opener.opening_name(); },
                       .load_alone =
                           [this] {
                               opener.put_away();
                               opener.bring_back();
                           },
                       .is_drawing_picture = [this] { return photographer.has_large(); },
                       .drop_screenshot = [this](const char* by) { photographer.drop_large(by); },
                       .note_edit = [this] { settings.note_edit(); },
                       .look_again = [this] { viewer.look_again(); }}};
    TaskRunner tasks{desk,
                     keeper,
                     {.end_save = [this](const Jobs::Finished& job) { saver.end(job); },
                      .end_reading =
                          [this](const Jobs::Finished& job) {
                              return groups.ends_preview(job) || opener.end_reading(job) || reloader.end_reading(job);
                          },
                      .cancel =
                          [this](Jobs::Number number) {
                              return opener.cancel(number) || reloader.cancel(number) || photographer.cancel(number);
                          },
                      .add_loading =
                          [this](std::vector<Jobs::State>& states) {
                              opener.add_loading(states);
                              reloader.add_loading(states);
                              photographer.add_loading(states);
                          },
                      .add_reading = [this](std::vector<Jobs::State>& states) { opener.add_read(states); },
                      .open = [this](const std::filesystem::path& path) { taker.act(Open{path}); },
                      .record_settings = [this] { settings.record_settings(); },
                      .stay_open = [this] { saver.stay_open(); }}};
    Saver saver{desk,
                keeper,
                {.begin_open = [this](const std::filesystem::path& path) { opener.begin_open(path, {}); },
                 .extend_stroke = [this] { painter.extend_stroke(); },
                 .finish_stroke = [this] { return painter.finish_stroke(); },
                 .is_stuck = [this] { return painter.is_stuck(); },
                 .note_progress = [this] { painter.note_progress(); },
                 .is_writing = [this] { return tasks.is_writing() || photographer.has_large(); },
                 .record_settings = [this] { settings.record_settings(); },
                 .discard = [this] { settings.discard(); },
                 .is_discarded = [this] { return settings.is_discarded(); },
                 .advance_jobs = [this] { tasks.advance(); },
                 .look_again = [this] { viewer.look_again(); }}};
    MeshShower meshes{desk, {.look_again = [this] { viewer.look_again(); }}};
    Hand hand{desk,
              keeper,
              {.look_from = [this](const Camera& camera) { viewer.look_from(camera); },
               .move_probe = [this](const glm::dvec3& point, bool jumps) { prober.move_probe(point, jumps); },
               .paint = [this](const PaintOp& stroke) { painter.act(stroke); },
               .trace = [this](const TraceOp& op) { tracer.trace(op); },
               .stem = [this] { return photographer.stem(); }}};

    /// Returns the service of a type.
    template <class Kind>
    Kind& of()
    {
        return std::get<Kind&>(std::tie(keeper, presets, looks, window, photographer, viewer, settings, reader, painter,
                                        prober, groups, tracer, taker, opener, reloader, tasks, saver, meshes, hand));
    }
};

}  // namespace shvr::ui
