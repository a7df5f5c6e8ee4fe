#pragma once
// Makes actions that change settings, from functions that edit a session. Pure; any thread.

#include "engine/session/session_patch.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns the action that makes the same changes of settings as `edit` makes in a copy of the session.
template <class Edit>
Set edited(const Session& session, const Edit& edit)
{
    Session after = session;
    edit(after);
    const std::string patch = patch_between(session, after);
    return {patch.empty() ? "{}" : patch};
}

/// Appends the action that makes the same changes of settings as `edit(Session&)`, if there are any changes.
template <class Edit>
void set(Actions& actions, const Model& model, const Edit& edit)
{
    if (Set action = edited(model.session, edit); action.patch != "{}") actions.emplace_back(std::move(action));
}

}  // namespace shvr::ui
