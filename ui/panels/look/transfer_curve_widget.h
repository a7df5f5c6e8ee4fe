#pragma once
// The curve of the transfer function over the histogram: what is drawn, and what the mouse does to it. Its parts below
// the curve are in panel_transfer_function.cpp. Between Window::begin_ui and Window::present, main thread.

#include "engine/session/session.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/curves/fine_drag.h"
#include "engine/workbench/curves/histogram_bars.h"
#include "engine/workbench/curves/transfer_curve.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// The widget's state between frames. All other state belongs to the session.
struct CurveState {
    TransferCurve::Grip grip = TransferCurve::Grip::nothing;
    size_t selected = 0;
    CurveRange range;         ///< range of the horizontal axis; fixed while dragging
    double grabbed_at = 0.0;  ///< intensity under the mouse at the last motion that shifted all points
    FineDrag held;            ///< the centre of the grabbed item
    bool is_logarithmic = true;
    VolumeStatistics bars_of;  ///< the statistics from which `bars` were made
    HistogramBars bars;
};

/// Call before the curve is drawn: forgets what belongs to another volume.
void follow_volume(const Model& model, CurveState& state);
/// Draws the curve, and the numbers of its axis or what is under the mouse.
void curve_widget(const Model& model, CurveState& state, Actions& actions);
/// Add the action that changes the transfer function.
void send(const TransferCurve& curve, const Model& model, Actions& actions);
void send(TransferCurve::Points points, const Model& model, Actions& actions);

}  // namespace shvr::ui
