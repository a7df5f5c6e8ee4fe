#pragma once
// Actions that measure distances. Measurements are kept while the scan is open, but are not saved.

#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Reader;

struct MeasureAt {  ///< sets one end of a measurement at the visible point; the second end completes it
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};

struct ClearMeasurements {};

struct CopyMeasurements {};  ///< copies all measurements to the clipboard as a table

inline constexpr const char* MEASURING_GROUP = "Measuring";

inline constexpr auto MEASURING_ACTIONS = std::tuple{
    row<MeasureAt, Reader>(
        {"measure_at", "Measure", MEASURING_GROUP, "sets one end of a distance at the point seen at a pixel of a pane"},
        [](auto& f, MeasureAt& a) {
            pane_field(f, a.pane);
            pixel_field(f, "pixel", a.pixel);
        }),
    row<ClearMeasurements, Reader>({"clear_measurements", "Remove measurements", MEASURING_GROUP,
                                    "removes all measured distances from the picture"},
                                   NO_FIELDS,
                                   [](const auto& model, const ClearMeasurements&) -> std::string {
                                       return model.measurements.empty() && !model.measuring_from
                                                  ? "nothing is measured"
                                                  : "";
                                   }),
    row<CopyMeasurements, Reader>({"copy_measurements", "Copy measurements", MEASURING_GROUP,
                                   "puts all measured distances onto the clipboard, as a table"},
                                  NO_FIELDS, [](const auto& model, const CopyMeasurements&) -> std::string {
                                      return model.measurements.empty() ? "nothing is measured" : "";
                                  })};

}  // namespace shvr::ui
