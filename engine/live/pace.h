#pragma once
// Estimates the device time of a unit of work from past graphs, and thus how many units fit into the next graph.
//
// Some pixels cost twenty times as much as others, and a graph that is too short does less harm than a graph that is
// too long. So the estimate is the maximum of the last eight graphs, and rises at once. After eight more graphs, slow
// measurements (as while a device's clock ramps up) and wrong ones no longer count. Used by one thread.

#include <algorithm>
#include <array>

namespace shvr {

class Pace {
public:
    static constexpr size_t GRAPHS = 8;

    /// `first_ms`: estimate until something has been measured.
    explicit Pace(double first_ms) : first_ms_(first_ms) {}
    /// Estimated time of one unit.
    double ms() const { return count_ == 0 ? first_ms_ : *std::max_element(last_.begin(), last_.begin() + known()); }
    /// Records that a graph of `units` units took `graph_ms`.
    void learn(double graph_ms, double units)
    {
        constexpr double MIN_MS = 1e-7;
        if (!(units > 0.0)) return;
        last_[count_++ % GRAPHS] = std::max(graph_ms / units, MIN_MS);
    }
    /// Returns how many units fit into `budget_ms`.
    double affords(double budget_ms) const { return budget_ms / ms(); }

private:
    std::ptrdiff_t known() const { return std::ptrdiff_t(std::min(count_, GRAPHS)); }
    double first_ms_;
    std::array<double, GRAPHS> last_{};
    size_t count_ = 0;
};

}  // namespace shvr
