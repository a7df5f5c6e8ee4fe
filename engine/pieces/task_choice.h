#pragma once
// Which task of a job runs: "2/8" on the command line, or the index of a Slurm job array. Any thread.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace shvr {

/// Task `index` of `of`; 0 <= index < of.
struct TaskChoice {
    int64_t index = 0;
    int64_t of = 1;

    bool operator==(const TaskChoice&) const = default;
    /// "2/8"
    std::string in_words() const;
    /// The part of `count` equal steps that this task makes: [lower, upper), possibly empty. The parts of all tasks
    /// follow each other, and differ by at most one step.
    struct Range {
        int64_t lower = 0, upper = 0;
    };
    Range range_of(int64_t count) const;
};
inline constexpr int64_t MAX_TASKS = 1'000'000;

/// Returns the value of an environment variable; null if it is not set.
using Environment = std::function<const char*(const char* name)>;

/// Parses "I/N", or "slurm". The latter takes the index from SLURM_ARRAY_TASK_ID, _MIN and _STEP, and the number of
/// tasks from _MAX or, without it, _COUNT; a job array of a list of indices that are not evenly spaced is refused.
/// Throws UsageError with a sentence.
TaskChoice task_choice(const std::string& text, const Environment& environment);

}  // namespace shvr
