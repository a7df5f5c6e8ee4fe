#pragma once
// The history as a list of steps, to display and to jump to a step. Pure; main thread only.

#include <optional>
#include <string>

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Row N is the state after N steps: row 0 is the initial state, row `rows - 1` the newest state.
struct HistoryList {
    const History* history = nullptr;
    size_t done = 0;        ///< number of steps done, without changed settings that are not a step yet
    bool is_ahead = false;  ///< true: changed settings are not a step yet; the last row, an additional one, shows them

    size_t rows() const;
    size_t present() const { return done + is_ahead; }
    std::string label_of(size_t row) const;
};
HistoryList history_list(const Model& model);

/// Returns the action that undoes or redoes as many steps as lead to a row; null if that row is the present state.
std::optional<Action> go_to_row(const HistoryList& list, size_t row);

/// Returns the bounding box, in voxels, of the changes in the step that leads to that row: paint, offsets, nodes and
/// ends of internodes, without their radii. Null if the step has no position, such as a change of settings. Fails if
/// the journal cannot be read.
struct PlaceBox {
    glm::dvec3 lower{0.0}, upper{0.0};  ///< in voxels
    glm::dvec3 middle() const { return (lower + upper) * 0.5; }
};
std::optional<PlaceBox> place_of_row(const HistoryList& list, const Model& model, size_t row);

}  // namespace shvr::ui
