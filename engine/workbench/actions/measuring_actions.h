#pragma once
// Actions that measure distances, paths and angles. Measurements are part of the session, and changes of them are steps
// of the history.

#include "engine/session/session.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Reader;

struct MeasureAt {  ///< sets a point of a measurement at the visible point; the last point completes it
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};

struct EndMeasure {};  ///< completes a path with the points that it has

struct TakeBackPoint {};  ///< removes the last point of a measurement that is begun

struct RenameMeasurement {
    size_t number = 1;  ///< from 1
    std::string to;
};

struct RemoveMeasurement {
    size_t number = 1;  ///< from 1
};

struct ClearMeasurements {};

struct CopyMeasurements {};  ///< copies all measurements to the clipboard as a table

inline constexpr const char* MEASURING_GROUP = "Measuring";

inline constexpr auto WHY_NOT_NUMBERED = [](const auto& model, const auto& action) -> std::string {
    return action.number > model.measurements.size() ? sentence("there is no measurement ", action.number) : "";
};

inline constexpr auto MEASURING_ACTIONS = std::tuple{
    row<MeasureAt, Reader>({"measure_at", "Measure", MEASURING_GROUP,
                            "sets a point of a distance, a path or an angle at the point seen at a pixel of a pane"},
                           [](auto& f, MeasureAt& a) {
                               pane_field(f, a.pane);
                               pixel_field(f, "pixel", a.pixel);
                           }),
    row<EndMeasure, Reader>(
        {"end_measure", "End the path", MEASURING_GROUP, "completes the measured path with the points that it has"},
        NO_FIELDS,
        [](const auto& model, const EndMeasure&) -> std::string {
            return model.measuring.size() < 2 || model.session.probe.measure != MeasureKind::path
                       ? "no path with two points is begun"
                       : "";
        }),
    row<TakeBackPoint, Reader>({"take_back_point", "Take back the point", MEASURING_GROUP,
                                "removes the last point of a measurement that is begun"},
                               NO_FIELDS,
                               [](const auto& model, const TakeBackPoint&) -> std::string {
                                   return model.measuring.empty() ? "no measurement is begun" : "";
                               }),
    row<RenameMeasurement, Reader>(
        {"rename_measurement", "Rename a measurement", MEASURING_GROUP, "gives a measurement a name"},
        [](auto& f, RenameMeasurement& a) {
            f.whole("number", a.number, 1, MAX_MEASUREMENTS, {.meaning = "from 1", .is_required = true});
            f.text("to", a.to, {.is_required = true});
        },
        WHY_NOT_NUMBERED),
    row<RemoveMeasurement, Reader>(
        {"remove_measurement", "Remove a measurement", MEASURING_GROUP, "removes a measurement"},
        [](auto& f, RemoveMeasurement& a) {
            f.whole("number", a.number, 1, MAX_MEASUREMENTS, {.meaning = "from 1", .is_required = true});
        },
        WHY_NOT_NUMBERED),
    row<ClearMeasurements, Reader>(
        {"clear_measurements", "Remove measurements", MEASURING_GROUP, "removes all measurements from the picture"},
        NO_FIELDS,
        [](const auto& model, const ClearMeasurements&) -> std::string {
            return model.measurements.empty() && model.measuring.empty() ? "nothing is measured" : "";
        }),
    row<CopyMeasurements, Reader>({"copy_measurements", "Copy measurements", MEASURING_GROUP,
                                   "puts all measurements onto the clipboard, as a table with units"},
                                  NO_FIELDS, [](const auto& model, const CopyMeasurements&) -> std::string {
                                      return model.measurements.empty() ? "nothing is measured" : "";
                                  })};

}  // namespace shvr::ui
