#include "engine/pieces/task_choice.h"

#include <map>

#include <doctest/doctest.h>

#include "engine/base/error.h"

using namespace shvr;

namespace {

using Variables = std::map<std::string, std::string>;

Environment environment_of(const Variables& variables)
{
    return [&variables](const char* name) {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
    };
}

TaskChoice chosen(const std::string& text, const Variables& variables = {})
{
    return task_choice(text, environment_of(variables));
}

}  // namespace

TEST_CASE("a task is I/N, counted from 0")
{
    CHECK(chosen("0/1") == TaskChoice{0, 1});
    CHECK(chosen("7/8") == TaskChoice{7, 8});
    CHECK(chosen("2/8").in_words() == "2/8");
    for (const char* text : {"8/8", "-1/8", "1", "/", "1/", "/8", "a/8", "1/0", "1/8/2", "", "Slurm", "0/1000001"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(chosen(text), UsageError);
    }
}

TEST_CASE("the environment decides nothing unless slurm is asked for")
{
    CHECK(chosen("0/3", {{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_MIN", "0"}, {"SLURM_ARRAY_TASK_MAX", "2"}}) ==
          TaskChoice{0, 3});
}

TEST_CASE("slurm: the index counts from the array's first, in its steps")
{
    Variables slurm{{"SLURM_ARRAY_TASK_ID", "14"},
                    {"SLURM_ARRAY_TASK_MIN", "10"},
                    {"SLURM_ARRAY_TASK_MAX", "16"},
                    {"SLURM_ARRAY_TASK_STEP", "2"}};
    CHECK(chosen("slurm", slurm) == TaskChoice{2, 4});
    // A resubmission of the first and the last task has another count, and the same indices.
    slurm["SLURM_ARRAY_TASK_COUNT"] = "2";
    CHECK(chosen("slurm", slurm) == TaskChoice{2, 4});
    slurm.erase("SLURM_ARRAY_TASK_MAX");
    slurm["SLURM_ARRAY_TASK_COUNT"] = "4";
    CHECK(chosen("slurm", slurm) == TaskChoice{2, 4});
    slurm.erase("SLURM_ARRAY_TASK_STEP");
    CHECK_THROWS_AS(chosen("slurm", slurm), UsageError);  // index 4 of 4
    slurm["SLURM_ARRAY_TASK_STEP"] = "3";
    CHECK_THROWS_AS(chosen("slurm", slurm), UsageError);  // 14 is not 10, 13, 16, 19
    slurm["SLURM_ARRAY_TASK_STEP"] = "2x";
    CHECK_THROWS_AS(chosen("slurm", slurm), UsageError);
    CHECK_THROWS_AS(chosen("slurm"), UsageError);
}

TEST_CASE("the ranges of all tasks follow each other and differ by at most one step")
{
    for (const int64_t of : {1, 2, 3, 7, 10}) {
        for (const int64_t count : {0, 1, 6, 7, 8, 100}) {
            int64_t next = 0;
            for (int64_t index = 0; index < of; ++index) {
                const TaskChoice::Range range = TaskChoice{index, of}.range_of(count);
                CHECK(range.lower == next);
                CHECK(range.upper - range.lower >= count / of);
                CHECK(range.upper - range.lower <= (count + of - 1) / of);
                next = range.upper;
            }
            CHECK(next == count);
        }
    }
}
