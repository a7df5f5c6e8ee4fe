#pragma once
// Operations on groups as actions: one row for each row of engine/annotation/operations/operations.h. Scripts use the
// same operations, in the same lines of JSON.

#include "engine/annotation/script/script.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class GroupEditor;

inline constexpr const char* OPERATIONS_GROUP = "Groups";

inline constexpr auto GROUP_ACTIONS = std::apply(
    [](const auto&... operations) {
        const auto action = []<class Operation>(const Operation& operation) {
            using Kind = typename Operation::Kind;
            return row<Kind, GroupEditor>(
                {operation.id, operation.title, OPERATIONS_GROUP, operation.meaning},
                [](auto& f, Kind& op) { operation_fields(f, op); },
                [](const auto& model, const Kind& op) { return why_not_operated(model, GroupOperation(op)); });
        };
        return std::tuple{action(operations)...};
    },
    OPERATIONS);

}  // namespace shvr::ui
