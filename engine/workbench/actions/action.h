#pragma once
// The actions of the user. Keys, mouse, menus, panels, the stylus and scripts only create actions; the workbench
// carries them out in one place, in order. Each action has a stable id, and arguments as JSON (action_rows.h), so it
// can be logged, replayed and written in a script. Plain data; any thread.

#include <variant>
#include <vector>

#include "engine/workbench/actions/group_actions.h"
#include "engine/workbench/actions/hand_actions.h"
#include "engine/workbench/actions/looking_actions.h"
#include "engine/workbench/actions/measuring_actions.h"
#include "engine/workbench/actions/painting_actions.h"
#include "engine/workbench/actions/probe_actions.h"
#include "engine/workbench/actions/settings_actions.h"
#include "engine/workbench/actions/tracing_actions.h"
#include "engine/workbench/actions/window_actions.h"
#include "engine/workbench/actions/work_actions.h"

namespace shvr::ui {

/// All rows of all tables, as types.
template <class Joined, class... Tables>
struct JoinedRows {
    using Type = Joined;
};
template <class... Joined, class... Rows, class... Tables>
struct JoinedRows<std::tuple<Joined...>, std::tuple<Rows...>, Tables...>
    : JoinedRows<std::tuple<Joined..., Rows...>, Tables...> {};
/// The rows in the order in which actions are listed.
using ActionRows =
    JoinedRows<std::tuple<>, std::remove_const_t<decltype(LOOKING_ACTIONS)>,
               std::remove_const_t<decltype(SETTINGS_ACTIONS)>, std::remove_const_t<decltype(PROBE_ACTIONS)>,
               std::remove_const_t<decltype(PAINTING_ACTIONS)>, std::remove_const_t<decltype(GROUP_ACTIONS)>,
               std::remove_const_t<decltype(TRACING_ACTIONS)>, std::remove_const_t<decltype(MEASURING_ACTIONS)>,
               std::remove_const_t<decltype(WORK_ACTIONS)>, std::remove_const_t<decltype(WINDOW_ACTIONS)>,
               std::remove_const_t<decltype(HAND_ACTIONS)>>::Type;

template <class Rows>
struct VariantOfRows;
template <class... Rows>
struct VariantOfRows<std::tuple<Rows...>> {
    using Type = std::variant<typename Rows::Kind...>;
};
using Action = VariantOfRows<ActionRows>::Type;
using Actions = std::vector<Action>;

/// Index of an alternative of Action, and of its row in the tables.
template <class Kind, class Rows = ActionRows>
inline constexpr size_t INDEX_OF_KIND = 0;
template <class Kind, class... Rows>
inline constexpr size_t INDEX_OF_KIND<Kind, std::tuple<Rows...>> = [] {
    constexpr bool IS_IT[] = {std::is_same_v<Kind, typename Rows::Kind>...};
    size_t index = 0;
    while (!IS_IT[index]) ++index;
    return index;
}();

}  // namespace shvr::ui
