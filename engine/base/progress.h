#pragma once
// Reports the progress of long-running work and stops such work; also the progress line that a user sees.

#include <functional>
#include <string>

#include "engine/base/error.h"

namespace shvr {

/// A function that long-running work calls at intervals, on its own thread, with the completed fraction (0 ... 1). If
/// the function throws, the work ends and leaves no partial result. If it is empty, progress is not reported.
using Progress = std::function<void(double fraction)>;

/// The work was stopped by the user.
class Stopped : public Error {
public:
    using Error::Error;
};

inline void tell(const Progress& progress, double fraction)
{
    if (progress) progress(fraction);
}

/// Returns the Progress for one part of the work: maps the part's 0 ... 1 to `lower` ... `upper` of the whole.
inline Progress part_of(const Progress& progress, double lower, double upper)
{
    if (!progress) return {};
    return [=](double fraction) { progress(lower + (upper - lower) * fraction); };
}

/// Formats a duration, rounded up: "5 s", "2 min 5 s", "3 h 20 min".
std::string duration_text(double seconds);

/// The progress line of a command. Prints nothing in the first second; then, on a terminal, one line that is rewritten,
/// and elsewhere at most one line every ten seconds. One thread at a time.
class ProgressLine {
public:
    struct Place {
        bool is_terminal = false;
        std::function<void(const std::string& text)> write;  ///< prints text unchanged, including control characters
                                                             ///< and line ends
        std::function<double()> seconds;                     ///< time since any fixed moment
    };
    explicit ProgressLine(Place place);
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;

    /// Starts a new stage of the work, such as "measuring", and estimates its time left from scratch.
    void begin(std::string what);
    /// A negative fraction means unknown: the time since `begin` is then shown. `detail`: shown after the fraction, as
    /// in "120 MB/s"; may be empty. Without `seconds_left`, the time left is estimated from the time since `begin`.
    void show(double fraction, const std::string& detail = {}, double seconds_left = -1.0);
    /// Erases the line from a terminal, before anything else is printed there.
    void clear();

private:
    Place place_;
    std::string what_;
    double started_, begun_ = 0.0, told_ = 0.0;
    double first_fraction_ = -1.0;  ///< fraction done before `begin`, as in a resumed import; negative: not set
    bool has_told_ = false, is_shown_ = false;
};

}  // namespace shvr
