#pragma once
// Divides the rows of a picture among ranks by counted work: each rank gets one strip of neighbouring rows, since the
// rays of neighbouring rows visit the same bricks. A picture that exceeds the memory for rows that wait is divided in
// several rounds, from the top. Plain values; one thread.

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace shvr {

/// Rows [lower, upper) of a picture.
struct RowStrip {
    int64_t lower = 0, upper = 0;
    bool operator==(const RowStrip&) const = default;
};

class RowPlan {
public:
    /// `work`: of equally high bands of the picture from the top, in any unit, as counted in a small picture; if it is
    /// empty, all rows count equally. `rows_at_once`: rows of a round.
    RowPlan(int64_t rows, const std::vector<double>& work, int ranks, int64_t rows_at_once);

    /// The next strip of a rank, from the top; null once it has had all.
    std::optional<RowStrip> peek(int rank) const;
    /// Returns the same strip, and goes on to the rank's next one.
    std::optional<RowStrip> next(int rank);

private:
    std::vector<std::deque<RowStrip>> strips_;  ///< by rank
};

}  // namespace shvr
