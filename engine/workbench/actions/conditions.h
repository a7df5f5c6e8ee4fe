#pragma once
// Conditions that several actions share. Each function returns why an action is unavailable now, in words that fit
// after a colon or into a tooltip; empty if the action is available. Pure; any thread.

#include <cstdint>
#include <string>

#include "engine/annotation/operations/operations.h"
#include "engine/base/text.h"

namespace shvr::ui {

struct Model;

inline constexpr const char *IS_PAINTING = "a stroke is being painted", *IS_SAVING = "the work is being saved";

/// Condition of every change of annotation.
std::string why_not_edited(const Model& model);
/// Condition of every change of the trace.
std::string why_not_traced(const Model& model);
std::string why_without_selection(const Model& model);
std::string why_without_node(const Model& model);
/// `group`: the group to which new nodes or internodes of the trace would belong.
std::string why_without_group(const Model& model, uint8_t group);
/// Condition of an operation on groups.
std::string why_not_operated(const Model& model, const GroupOperation& operation);
/// `name`: name of a transfer function; those that ship cannot be changed, only those that the user saved.
std::string why_not_own(const Model& model, const std::string& name);
/// Condition of a movie that goes through views, named one per line: they need the same projection.
std::string why_not_through(const Model& model, const std::string& views);

}  // namespace shvr::ui
