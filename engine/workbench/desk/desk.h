#pragma once
// State that all services of the workbench share: the open document, the renderer, messages, and the two workers. Main
// thread only.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/jobs/jobs.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/document/document.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/sight/figure.h"
#include "engine/workbench/touch/device_watch.h"

namespace shvr::ui {

/// Returns the last part of a path, even if the path ends with a slash.
std::string short_name(const std::filesystem::path& path);

struct WorkbenchOptions {
    View::Options view{};
    bool has_servo = true;  ///< enables guidance and haptic devices; false: guidance has no effect
    /// Set while a script runs, which must do exactly what it states: settings become no history steps and are not
    /// saved, saves write only the annotation files that the session names, and nothing is selected automatically.
    bool is_script = false;
    bool saves_outside = false;  ///< sessions may write outside their folders without asking
    bool allow_force = false;    ///< allows a haptic device with a verified profile to exert forces
    /// Folder for preferences, saved transfer functions and the user's copy of the example; empty: there is none.
    std::filesystem::path settings{};
    bool has_preferences = true;      ///< false: uses default preferences, and saves no changes of them
    std::function<double()> now_s{};  ///< a clock, in seconds; null: uses the system's clock
    std::string version{};            ///< the program's, for reports; empty: unknown
    DeviceSource devices{};           ///< lists and opens haptic devices; without functions: those of this machine
    /// Slices follow a probe that leaves their plane, by an action that is logged; false: only the script moves them.
    bool slices_follow = true;
    TextDrawer draw_texts{};  ///< draws labels into picture files; null: no labels
};

struct Desk {
    Desk(Renderer& with, WorkbenchOptions how);
    Desk(const Desk&) = delete;

    Renderer& renderer;
    WorkbenchOptions options;
    /// The open document; null: nothing is open. Opening replaces the document, so services keep a reference to this
    /// pointer, never to the document itself.
    std::unique_ptr<Document> document;
    uint64_t openings = 0;  ///< how often a document was opened
    double opened_s = 0.0;  ///< when this one was
    MessageLog messages;
    bool are_messages_shown = false;  ///< while messages are shown, all of them count as read
    std::function<void(const std::string&)> log;
    std::vector<std::string> logged_instead;  ///< lines to log in place of the action being carried out
    Jobs jobs;
    Jobs savers{{.wake = {}, .seconds = {}, .first = Jobs::Number{1} << 32}};  ///< saves wait for no other job
    /// Both are the workbench's, which sets them.
    std::function<bool(const Action&)> apply;
    std::function<Model()> model;

    void say(std::string text, Weight weight = Weight::done);
    /// Logs `actions` in place of the action being carried out. For example, the point seen at a pixel depends on the
    /// paint and bricks at that moment, so a replayable log states the point's position instead of the pixel.
    void log_instead(const Actions& actions);
    DocumentModel document_model() const;
    /// Empty objects, to which the references in a model refer while no document is open.
    struct Nothing {
        Session session;
        VolumeInfo volume;
        VolumeStatistics statistics;
        Camera camera;
        std::vector<Screen::Part> panes;
        TraceGraph trace;
        std::filesystem::path path;
    };
    const Nothing nothing{};
};

}  // namespace shvr::ui
