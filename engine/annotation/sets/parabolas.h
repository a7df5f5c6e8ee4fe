#pragma once
// Lower envelopes of parabolas, for exact distances axis by axis (Felzenszwalb and Huttenlocher 2012).

#include <cstdint>
#include <limits>
#include <vector>

namespace shvr {

inline constexpr double INFINITE = std::numeric_limits<double>::infinity();

/// Computes min over j of f(j) + (spacing (i - j))^2 for i in [first, end); samples of f are `spacing` apart.
class Parabolas {
public:
    explicit Parabolas(double spacing) : square_(spacing * spacing) {}
    /// `at(j)` returns f(j); values above `most` count as infinite. Returns false if all values are infinite.
    template <class At>
    bool build(int64_t count, double most, const At& at)
    {
        hulls_.clear();
        for (int64_t j = 0; j < count; ++j) {
            const double value = at(j);
            if (!(value <= most)) continue;
            double from = -INFINITE;
            while (!hulls_.empty()) {
                const Hull& last = hulls_.back();
                // The position where the parabolas of `last` and j intersect.
                from = 0.5 * (double(j + last.at) + (value - last.value) / (square_ * double(j - last.at)));
                if (from > last.from) break;
                hulls_.pop_back();
                from = -INFINITE;
            }
            hulls_.push_back({j, value, from});
        }
        return !hulls_.empty();
    }
    template <class Take>
    void evaluate(int64_t first, int64_t end, const Take& take) const
    {
        size_t hull = 0;
        for (int64_t i = first; i < end; ++i) {
            while (hull + 1 < hulls_.size() && hulls_[hull + 1].from < double(i)) ++hull;
            const auto away = double(i - hulls_[hull].at);
            take(i, hulls_[hull].value + square_ * away * away);
        }
    }

private:
    struct Hull {
        int64_t at;
        double value, from;
    };
    double square_;
    std::vector<Hull> hulls_;
};

}  // namespace shvr
