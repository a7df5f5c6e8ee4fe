#pragma once
// The transfer function as a curve edited by hand: positions on a rectangle, hit tests for the mouse, and
// changes of the points. Pure; any thread.
//
// Intensities increase from left to right. The vertical axis is the square root of opacity, so that small opacities can
// be seen and dragged.

#include <optional>
#include <vector>

#include "engine/look/transfer_function.h"

namespace shvr::ui {

/// Intensities and opacities in pixels, y down.
struct CurveAxes {
    glm::vec2 begin{0.0f}, end{1.0f};  ///< upper left and lower right corner
    double lower = 0.0, upper = 1.0;   ///< intensities at the left and right edges

    float x_of(double intensity) const;
    float y_of(double opacity) const;
    double intensity_at(float x) const;
    double opacity_at(float y) const;
    glm::vec2 place_of(const ControlPoint& point) const;
};

/// The range of intensities that a widget shows: it contains the volume's and the function's range.
struct CurveRange {
    double lower = 0.0, upper = 1.0;
};
CurveRange range_of_curve(const TransferFunction& function, double lowest, double highest);

class TransferCurve {
public:
    using Points = std::vector<ControlPoint>;
    enum class Grip { nothing, point, all_points, paint_threshold, haptic_threshold };
    struct Found {
        Grip grip = Grip::nothing;
        size_t point = 0;
        bool operator==(const Found&) const = default;
    };
    /// The threshold lines, and the horizontal extent of their labels. The paint threshold's label is in the upper row.
    struct Lines {
        double paint_threshold = 0.0, haptic_threshold = 0.0;
        glm::vec2 paint_word{0.0f}, haptic_word{0.0f};
    };
    /// Maximum grab distances of the mouse: points within `pixels`, then labels (rows of height `label`), then lines.
    /// If both lines coincide, the mouse grabs the paint threshold, except in the row of the haptic threshold's label.
    struct Reach {
        float pixels = 9.0f, label = 17.0f;
    };

    explicit TransferCurve(const TransferFunction& function)
        : points_(function.points().begin(), function.points().end())
    {}
    const Points& points() const { return points_; }
    /// Returns the edited function, with values clamped to the range that transfer functions allow.
    TransferFunction function() const;

    /// Returns the item under the mouse. Points take precedence over lines; of several items, the nearest is returned.
    Found under(const CurveAxes& axes, const glm::vec2& mouse, const Lines& lines, const Reach& reach) const;

    /// Inserts a point whose colour is that of the function at this intensity. Returns the point's index.
    size_t add(double intensity, double opacity);
    /// Removes a point unless only two are left. Returns the index of the point to select afterwards.
    size_t remove(size_t point);
    /// Moves a point, but only between its neighbours, so that its index stays the same.
    void move(size_t point, double intensity, double opacity);
    double held_between_neighbors(size_t point, double intensity) const;
    /// Shifts all points by `by`, limited so that the curve still overlaps [lowest, highest]. Returns the actual shift.
    double shift_all(double by, double lowest, double highest);

private:
    Points points_;
};

/// Returns how far one wheel notch shifts all points: a fraction of the displayed range, or a tenth of that if slow. If
/// voxels are integers, the shift is a whole number, at least one.
double wheel_shift(double notches, const CurveRange& range, bool is_slow, bool is_whole);

}  // namespace shvr::ui
