#pragma once
// A row of the tables of actions. A table stands below the structs of its actions. Each row is one action: id, name,
// group, meaning, arguments, condition, and the service whose `act` carries it out. Everything else follows from the
// tables: Action (action.h), lines of JSON and text (action_rows.h), dispatch (workbench.cpp).
//
// Arguments and conditions are generic functions, so that headers with tables need neither Fields nor Model:
// action_rows.cpp instantiates them.

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <glm/glm.hpp>

#include "engine/workbench/actions/argument_ranges.h"
#include "engine/workbench/actions/conditions.h"

namespace shvr::ui {

/// Says whether an action needs an open document.
enum class Needs : uint8_t { document, nothing };

struct ActionRow {
    const char* id = "";       ///< never changes: files refer to it
    const char* name = "";     ///< "Turn the view"
    const char* group = "";    ///< "Looking"
    const char* meaning = "";  ///< one sentence
    Needs needs = Needs::document;
};

/// `fields(Fields&, Kind&)` visits the arguments. `why_not(const Model&, const Kind&)` returns why the action would do
/// nothing, or an empty text if it is available. `Service` must have `void act(const Kind&)`.
template <class KindOfRow, class ServiceOfRow, class VisitFields, class WhyNot>
struct FullRow : ActionRow {
    using Kind = KindOfRow;
    using Service = ServiceOfRow;
    VisitFields fields;
    WhyNot why_not;
};

inline constexpr auto NO_FIELDS = [](auto&, auto&) {};
/// The fields of a task, as defined in engine/tasks.
inline constexpr auto TASK_FIELDS = [](auto& f, auto& task) { fields(f, task); };
inline constexpr auto NO_CONDITION = [](const auto&, const auto&) { return std::string(); };

template <class Kind, class Service, class VisitFields = decltype(NO_FIELDS), class WhyNot = decltype(NO_CONDITION)>
constexpr auto row(const ActionRow& texts, VisitFields fields = {}, WhyNot why_not = {})
{
    return FullRow<Kind, Service, VisitFields, WhyNot>{texts, fields, why_not};
}

}  // namespace shvr::ui
