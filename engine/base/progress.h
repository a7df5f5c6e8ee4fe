#pragma once
// How long work says how far it is, and how it is stopped; and the line of text that a person sees of it.

#include <functional>
#include <string>

#include "engine/base/error.h"

namespace shvr {

/// Called now and then by long work, on the thread that asked for it, with the share that is done (0 ... 1). What it
/// throws ends the work, which then leaves nothing half done. An empty function: nobody wants to know.
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

/// For a part of the work: its 0 ... 1 is `lower` ... `upper` of the whole. `progress` is copied.
inline Progress part_of(const Progress& progress, double lower, double upper)
{
    if (!progress) return {};
    return [=](double fraction) { progress(lower + (upper - lower) * fraction); };
}

/// "5 s", "2 min 5 s", "3 h 20 min": rounded up.
std::string duration_text(double seconds);

/// What a person sees while a command runs: nothing in the first second; then on a terminal one line that is rewritten,
/// elsewhere at most one line every ten seconds. One thread at a time.
class ProgressLine {
public:
    struct Place {
        bool is_terminal = false;
        std::function<void(const std::string& text)> write;  ///< as it is, with its control characters and line ends
        std::function<double()> seconds;                     ///< since any moment
    };
    explicit ProgressLine(Place place);
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;

    /// A new stretch of work begins, as in "measuring"; its time left is estimated anew.
    void begin(std::string what);
    /// A share below 0 is not known; then the time since `begin` is said. `detail`: said after the share, as in
    /// "120 MB/s"; may be empty. Without `seconds_left` that is estimated from the time since `begin`.
    void show(double fraction, const std::string& detail = {}, double seconds_left = -1.0);
    /// Takes the line away from a terminal, before anything else is printed there.
    void clear();

private:
    Place place_;
    std::string what_;
    double started_, begun_ = 0.0, told_ = 0.0;
    double first_fraction_ = -1.0;  ///< work that was done before `begin`, as in a resumed import; below 0: none seen
    bool has_told_ = false, is_shown_ = false;
};

}  // namespace shvr
