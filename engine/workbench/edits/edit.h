#pragma once
// Creates actions that change settings. Pure; any thread.

#include "engine/session/session_patch.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns the action that changes the settings as `edit` does.
template <class Edit>
Set edited(const Session& session, const Edit& edit)
{
    Session after = session;
    edit(after);
    const std::string patch = patch_between(session, after);
    return {patch.empty() ? "{}" : patch};
}

/// Adds an action that changes the settings as `edit(Session&)` does, if it changes anything.
template <class Edit>
void set(Actions& actions, const Model& model, const Edit& edit)
{
    if (Set action = edited(model.session, edit); action.patch != "{}") actions.emplace_back(std::move(action));
}

}  // namespace shvr::ui
