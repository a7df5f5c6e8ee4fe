#pragma once
// The steps of the history as a list to look at and to jump in. Pure; the main thread.

#include <optional>
#include <string>

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// A row is the state after so many steps: row 0 is the beginning, row `rows - 1` the newest.
struct HistoryList {
    const History* history = nullptr;
    size_t done = 0;        ///< the present row, where no setting waits to be a step
    bool is_ahead = false;  ///< a setting was changed that is not a step yet: the last row, and the present one

    size_t rows() const;
    size_t present() const { return done + is_ahead; }
    std::string label_of(size_t row) const;
};
HistoryList history_list(const Model& model);

/// Undo or redo of as many steps as it takes; nothing where that is the present row.
std::optional<Action> go_to_row(const HistoryList& list, size_t row);

/// The voxels from the least to the greatest that the step leading to that row changes: of paint and offsets, and of
/// nodes and ends of internodes with their radii left out. Nothing where it changes no place, as settings do. Fails
/// where the journal cannot be read.
struct PlaceBox {
    glm::dvec3 lower{0.0}, upper{0.0};  ///< in voxels
    glm::dvec3 middle() const { return (lower + upper) * 0.5; }
};
std::optional<PlaceBox> place_of_row(const HistoryList& list, const Model& model, size_t row);

}  // namespace shvr::ui
