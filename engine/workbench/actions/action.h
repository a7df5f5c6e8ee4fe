#pragma once
// The actions of the user. Keys, mouse, menus, panels, the stylus and scripts only create actions; the workbench
// carries them out in one place, in order. Each action has a stable id, and arguments as JSON (action_rows.h), so it
// can be logged, replayed and written in a script. Immutable data; any thread.

#include <memory>
#include <utility>
#include <vector>

#include "engine/workbench/actions/group_actions.h"
#include "engine/workbench/actions/hand_actions.h"
#include "engine/workbench/actions/look_actions.h"
#include "engine/workbench/actions/looking_actions.h"
#include "engine/workbench/actions/measuring_actions.h"
#include "engine/workbench/actions/painting_actions.h"
#include "engine/workbench/actions/picture_actions.h"
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
/// A tuple of the rows of all the tables above, in the order in which actions are listed to users.
using ActionRows =
    JoinedRows<std::tuple<>, std::remove_const_t<decltype(LOOKING_ACTIONS)>,
               std::remove_const_t<decltype(SETTINGS_ACTIONS)>, std::remove_const_t<decltype(LOOK_ACTIONS)>,
               std::remove_const_t<decltype(PROBE_ACTIONS)>, std::remove_const_t<decltype(PAINTING_ACTIONS)>,
               std::remove_const_t<decltype(GROUP_ACTIONS)>, std::remove_const_t<decltype(TRACING_ACTIONS)>,
               std::remove_const_t<decltype(MEASURING_ACTIONS)>, std::remove_const_t<decltype(WORK_ACTIONS)>,
               std::remove_const_t<decltype(PICTURE_ACTIONS)>, std::remove_const_t<decltype(WINDOW_ACTIONS)>,
               std::remove_const_t<decltype(HAND_ACTIONS)>>::Type;

/// Whether one of the tables has a row for the struct `Kind`.
template <class Kind, class Rows = ActionRows>
inline constexpr bool IS_ACTION = false;
template <class Kind, class... Rows>
inline constexpr bool IS_ACTION<Kind, std::tuple<Rows...>> = (std::is_same_v<Kind, typename Rows::Kind> || ...);

/// Index of the row for the struct `Kind`, among the rows of all tables.
template <class Kind, class Rows = ActionRows>
inline constexpr size_t INDEX_OF_KIND = 0;
template <class Kind, class... Rows>
inline constexpr size_t INDEX_OF_KIND<Kind, std::tuple<Rows...>> = [] {
    constexpr bool IS_IT[] = {std::is_same_v<Kind, typename Rows::Kind>...};
    size_t index = 0;
    while (!IS_IT[index]) ++index;
    return index;
}();

/// Holds one of the structs in the tables; copies share it. Not a std::variant, whose type would put every struct's
/// name into every symbol: a file that creates one action took 8 s longer to compile, to 35 MB more object code.
class Action {
public:
    template <class Kind>
    requires IS_ACTION<Kind> Action(Kind kind)
        : index_(INDEX_OF_KIND<Kind>), kind_(std::make_shared<const Kind>(std::move(kind)))
    {}

    /// The index of its row.
    size_t index() const { return index_; }
    template <class Kind>
    bool is() const
    {
        return index_ == INDEX_OF_KIND<Kind>;
    }
    /// Returns null for an action of another kind.
    template <class Kind>
    const Kind* as() const
    {
        return is<Kind>() ? static_cast<const Kind*>(kind_.get()) : nullptr;
    }
    /// Calls `visitor` with the struct. The visitor must accept every kind, and return the same type for each.
    template <class Visitor>
    auto visit(const Visitor& visitor) const
    {
        return visit_rows(visitor, static_cast<ActionRows*>(nullptr));
    }

private:
    template <class Visitor, class First, class... Rest>
    auto visit_rows(const Visitor& visitor, std::tuple<First, Rest...>*) const
    {
        using Result = decltype(visitor(std::declval<const typename First::Kind&>()));
        using Call = Result (*)(const Visitor&, const void*);
        static constexpr Call CALLS[] = {&call<Visitor, Result, typename First::Kind>,
                                         &call<Visitor, Result, typename Rest::Kind>...};
        return CALLS[index_](visitor, kind_.get());
    }
    template <class Visitor, class Result, class Kind>
    static Result call(const Visitor& visitor, const void* kind)
    {
        return visitor(*static_cast<const Kind*>(kind));
    }

    size_t index_;
    std::shared_ptr<const void> kind_;
};
using Actions = std::vector<Action>;

}  // namespace shvr::ui
