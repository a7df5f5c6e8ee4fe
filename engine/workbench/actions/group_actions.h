#pragma once
// Operations on groups as actions: one row for each row of engine/annotation/operations/operations.h. Scripts use the
// same operations, in the same lines of JSON.

#include "engine/annotation/script/script.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class GroupEditor;

inline constexpr const char* OPERATIONS_GROUP = "Groups";

/// Shows what an operation would change, in words and in the picture.
struct PreviewOperation {
    std::string operation;  ///< the line of a script that performs it; empty: nothing is previewed any more
};

inline constexpr auto OPERATION_ACTIONS = std::apply(
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

inline constexpr auto GROUP_ACTIONS = std::tuple_cat(
    OPERATION_ACTIONS, std::tuple{row<PreviewOperation, GroupEditor>(
                           {"preview_operation", "Preview an operation", OPERATIONS_GROUP,
                            "shows what an operation on groups would change, without changing it; empty: ends that"},
                           [](auto& f, PreviewOperation& a) {
                               f.text("operation", a.operation, {"the line of a script that performs the operation"});
                           },
                           [](const auto& model, const PreviewOperation& action) -> std::string {
                               if (action.operation.empty())
                                   return model.previewed.empty() ? "no operation is previewed" : "";
                               return model.is_open ? "" : "nothing is open";
                           })});

}  // namespace shvr::ui
