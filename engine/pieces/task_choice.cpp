#include "engine/pieces/task_choice.h"

#include <algorithm>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

/// Returns a whole number that Slurm sets for each task of a job array; null if it is not set.
std::optional<int64_t> slurm_number(const char* name, const Environment& environment)
{
    const char* const text = environment(name);
    if (text == nullptr) return std::nullopt;
    const std::optional<int64_t> number = whole_of(text);
    if (!number || *number < 0)
        throw UsageError(sentence("--task slurm: ", name, " is ", in_quotes(text), "; expected a whole number from 0"));
    return number;
}

TaskChoice slurm_task(const Environment& environment)
{
    const auto required = [&](const char* name) {
        const std::optional<int64_t> number = slurm_number(name, environment);
        if (!number)
            throw UsageError(sentence("--task slurm: ", name,
                                      " is not set; expected a task of a job array (sbatch --array=0-7), or I/N, as in "
                                      "--task 2/8"));
        return *number;
    };
    const int64_t id = required("SLURM_ARRAY_TASK_ID"), least = required("SLURM_ARRAY_TASK_MIN");
    const int64_t step = std::max<int64_t>(slurm_number("SLURM_ARRAY_TASK_STEP", environment).value_or(1), 1);
    const std::optional<int64_t> most = slurm_number("SLURM_ARRAY_TASK_MAX", environment);
    const int64_t of = most ? (*most - least) / step + 1 : required("SLURM_ARRAY_TASK_COUNT");
    if (id < least || (id - least) % step != 0 || (id - least) / step >= of || of > MAX_TASKS)
        throw UsageError(sentence("--task slurm: the index ", id, " is none of ", of, " from ", least, " in steps of ",
                                  step,
                                  "; expected evenly spaced indices of a job array, as in sbatch --array=0-7, or "
                                  "I/N, as in --task 2/8"));
    return {(id - least) / step, of};
}

}  // namespace

std::string TaskChoice::in_words() const
{
    return sentence(index, '/', of);
}

TaskChoice::Range TaskChoice::range_of(int64_t count) const
{
    const int64_t each = count / of, longer = count % of;  // the first `longer` tasks make one step more
    const int64_t lower = index * each + std::min(index, longer);
    return {lower, lower + each + (index < longer ? 1 : 0)};
}

TaskChoice task_choice(const std::string& text, const Environment& environment)
{
    if (text == "slurm") return slurm_task(environment);
    const size_t slash = std::min(text.find('/'), text.size());
    const std::optional<int64_t> index = whole_of(std::string_view(text).substr(0, slash));
    const std::optional<int64_t> of = whole_of(std::string_view(text).substr(std::min(slash + 1, text.size())));
    if (!index || !of || *of < 1 || *of > MAX_TASKS || *index < 0 || *index >= *of)
        throw UsageError(
            sentence("--task is ", in_quotes(text), "; expected I/N, with I from 0 to N - 1, as in 2/8, or slurm"));
    return {*index, *of};
}

}  // namespace shvr
