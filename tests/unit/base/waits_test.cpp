#include <doctest/doctest.h>

#include <atomic>

#include "engine/base/progress.h"
#include "engine/base/waits/waits.h"
#include "engine/base/waits/work_pool.h"
#include "engine/jobs/jobs.h"

using namespace shvr;

TEST_CASE("waits: the threads of a pool wait no longer than the thread that made it")
{
    std::atomic<bool> is_over = false;
    const WaitsUntil waits([&] { return is_over.load(); });
    WorkPool pool(2, [&] { is_over = true; });
    CHECK_THROWS_AS(pool.run(4,
                             [](int64_t, int) {
                                 for (;;) stop_if_wait_is_over();
                             }),
                    Stopped);
    CHECK(waits_of_this_thread()());
}

TEST_CASE("waits: a thread without conditions hands on none, and all that nest are handed on")
{
    CHECK_FALSE(waits_of_this_thread()());
    bool inner = false, outer = false;
    const WaitsUntil first([&] { return outer; });
    const WaitsUntil second([&] { return inner; });
    const std::function<bool()> handed_on = waits_of_this_thread();
    CHECK_FALSE(handed_on());
    outer = true;
    CHECK(handed_on());
    outer = false;
    inner = true;
    CHECK(handed_on());
}

TEST_CASE("waits: a job that waits ends when it is cancelled")
{
    Jobs jobs;
    std::atomic<bool> has_begun = false;
    const Jobs::Number number = jobs.start("waiting", [&](ProgressReporter&) -> Jobs::Completion {
        has_begun = true;
        for (;;) stop_if_wait_is_over();
    });
    while (!has_begun) {
    }
    jobs.cancel(number);
    const std::vector<Jobs::Finished> ended = jobs.wait();
    REQUIRE(ended.size() == 1);
    CHECK(ended[0].was_cancelled);
    CHECK(ended[0].failure.empty());
}
