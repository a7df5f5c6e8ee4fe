#pragma once
// All services of the workbench. They are destroyed in reverse order, before the desk that they share.

#include <tuple>

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/preset_shelf.h"
#include "engine/workbench/desk/window_state.h"
#include "engine/workbench/services/file_taker.h"
#include "engine/workbench/services/hand.h"
#include "engine/workbench/services/opener.h"
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
    WindowState window{desk, keeper};
    Photographer photographer{*this};
    Viewer viewer{*this};
    SettingsEditor settings{*this};
    Reader reader{*this};
    Painter painter{*this};
    Prober prober{*this};
    Tracer tracer{*this};
    FileTaker taker{*this};
    Opener opener{*this};
    Reloader reloader{*this};
    TaskRunner tasks{*this};
    Saver saver{*this};
    Hand hand{*this};

    /// Returns the service of a type.
    template <class Kind>
    Kind& of()
    {
        return std::get<Kind&>(std::tie(keeper, presets, window, photographer, viewer, settings, reader, painter,
                                        prober, tracer, taker, opener, reloader, tasks, saver, hand));
    }
};

}  // namespace shvr::ui
