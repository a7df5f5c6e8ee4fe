#include "engine/jobs/jobs.h"

#include <latch>
#include <map>
#include <random>
#include <stdexcept>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

/// A job that runs until it is told to go on, or cancelled.
struct Gate {
    std::latch began{1};
    std::atomic<bool> is_open = false;
    Jobs::Function job(Jobs::Completion completion = {})
    {
        return [this, completion](ProgressReporter& reporter) {
            const Progress progress = reporter.begin("waiting at the gate");
            began.count_down();
            while (!is_open) {
                progress(0.5);
                std::this_thread::yield();
            }
            return completion;
        };
    }
};

Jobs::Function job_that_throws(const std::function<void()>& run)
{
    return [run](ProgressReporter&) -> Jobs::Completion {
        run();
        return {};
    };
}

}  // namespace

TEST_CASE("jobs run elsewhere one after the other in the order of their start, and are completed here")
{
    Jobs jobs;
    const std::thread::id here = std::this_thread::get_id();
    std::vector<int> ran, completed;  // the worker's until its last job ended, which wait() sees
    for (int i = 0; i < 20; ++i)
        CHECK(jobs.start(sentence("job ", i), [&, i](ProgressReporter&) -> Jobs::Completion {
            CHECK(std::this_thread::get_id() != here);
            ran.push_back(i);
            return [&, i] {
                CHECK(std::this_thread::get_id() == here);
                completed.push_back(i);
            };
        }) == Jobs::Number(i + 1));
    CHECK(!jobs.is_idle());
    const std::vector<Jobs::Finished> finished = jobs.wait();
    CHECK(jobs.is_idle());
    REQUIRE(finished.size() == 20);
    for (int i = 0; i < 20; ++i) {
        CHECK(ran[size_t(i)] == i);
        CHECK(completed[size_t(i)] == i);
        CHECK(finished[size_t(i)].number == Jobs::Number(i + 1));
        CHECK(finished[size_t(i)].what == sentence("job ", i));
        CHECK(finished[size_t(i)].is_done());
    }
    CHECK(jobs.finish().empty());
}

TEST_CASE("a job says what it does, how far it is and how long the rest of a stretch takes")
{
    std::atomic<double> now = 100.0;
    Jobs jobs({.seconds = [&] { return now.load(); }});
    std::latch told{1}, seen{1}, told_again{1}, seen_again{1};
    jobs.start("exporting", [&](ProgressReporter& reporter) -> Jobs::Completion {
        const Progress progress = reporter.begin("writing a.swc");
        now = 110.0;
        progress(0.2);  // its duration is unknown: an import may have been resumed
        now = 120.0;
        progress(0.6);  // 0.4 in 20 s since the stretch began
        told.count_down();
        seen.wait();
        reporter.begin("writing a.tif");
        now = 130.0;
        reporter.show(0.25, "120 MB/s", 7.0);
        told_again.count_down();
        seen_again.wait();
        return {};
    });
    jobs.start("labelling", [](ProgressReporter&) { return Jobs::Completion{}; });
    told.wait();
    std::vector<Jobs::State> states = jobs.states();
    REQUIRE(states.size() == 2);
    CHECK(states[0].what == "exporting");
    CHECK(states[0].stretch == "writing a.swc");
    CHECK(states[0].fraction == 0.6);
    CHECK(states[0].seconds == 20.0);
    CHECK(states[0].seconds_left == doctest::Approx(20.0));
    CHECK(!states[0].is_waiting);
    CHECK(states[1].what == "labelling");
    CHECK(states[1].is_waiting);
    CHECK(states[1].fraction < 0.0);
    CHECK(states[1].seconds_left < 0.0);
    seen.count_down();
    told_again.wait();
    states = jobs.states();
    CHECK(states[0].stretch == "writing a.tif");
    CHECK(states[0].detail == "120 MB/s");
    CHECK(states[0].seconds == 30.0);
    CHECK(states[0].seconds_left == 7.0);
    seen_again.count_down();
    CHECK(jobs.wait().size() == 2);
    CHECK(jobs.states().empty());
}

TEST_CASE("a cancelled job does not begin, or ends at its next step, and is not completed")
{
    Jobs jobs;
    Gate gate;
    bool was_completed = false, has_begun = false;
    const Jobs::Number running = jobs.start("running", gate.job([&] { was_completed = true; }));
    const Jobs::Number waiting = jobs.start("waiting", [&](ProgressReporter&) {
        has_begun = true;
        return Jobs::Completion{};
    });
    gate.began.wait();
    jobs.cancel(waiting);
    jobs.cancel(waiting);
    jobs.cancel(77);
    REQUIRE(jobs.states().size() == 1);
    CHECK(!jobs.states()[0].is_cancelled);
    const std::vector<Jobs::Finished> first = jobs.finish();
    REQUIRE(first.size() == 1);
    CHECK(first[0].number == waiting);
    CHECK(first[0].was_cancelled);
    jobs.cancel(running);
    const std::vector<Jobs::Finished> second = jobs.wait();
    REQUIRE(second.size() == 1);
    CHECK(second[0].was_cancelled);
    CHECK(second[0].failure == "");
    CHECK(!second[0].is_done());
    CHECK(!was_completed);
    CHECK(!has_begun);
    jobs.cancel(running);
}

TEST_CASE("all jobs can be cancelled at once, and each is told")
{
    Jobs jobs;
    Gate gate;
    jobs.start("running", gate.job([] { FAIL("ran"); }));
    for (int i = 0; i < 3; ++i) jobs.start("waiting", [](ProgressReporter&) { return Jobs::Completion{}; });
    gate.began.wait();
    jobs.cancel_all();
    const std::vector<Jobs::Finished> finished = jobs.wait();
    CHECK(finished.size() == 4);
    for (const Jobs::Finished& each : finished) CHECK(each.was_cancelled);
}

TEST_CASE("a job that came to its end before it saw that it is cancelled is not completed either")
{
    std::latch ended{1};
    Jobs jobs({.wake = [&] { ended.count_down(); }});
    bool was_completed = false;
    const Jobs::Number number =
        jobs.start("quick", [&](ProgressReporter&) -> Jobs::Completion { return [&] { was_completed = true; }; });
    ended.wait();
    jobs.cancel(number);
    const std::vector<Jobs::Finished> finished = jobs.finish();
    REQUIRE(finished.size() == 1);
    CHECK(finished[0].was_cancelled);
    CHECK(!was_completed);
}

TEST_CASE("whatever a job or its completion throws is its failure, and the next one runs")
{
    Jobs jobs;
    jobs.start("a", job_that_throws([] { fail("disk.raw: is full"); }));
    jobs.start("b", job_that_throws([] { throw std::bad_alloc(); }));
    jobs.start("c", job_that_throws([] { throw 7; }));
    jobs.start("d", job_that_throws([] { throw Stopped("not cancelled, but stopped"); }));
    jobs.start("e", [](ProgressReporter&) -> Jobs::Completion { return [] { fail("no room for the result"); }; });
    jobs.start("f", [](ProgressReporter&) -> Jobs::Completion { return [] { throw "text"; }; });
    jobs.start("g", [](ProgressReporter&) { return Jobs::Completion{}; });
    const std::vector<Jobs::Finished> finished = jobs.wait();
    REQUIRE(finished.size() == 7);
    const char* const failures[] = {"disk.raw: is full",
                                    "host memory is exhausted while b; expected more, or a smaller --budget-host",
                                    "an error of an unknown kind",
                                    "not cancelled, but stopped",
                                    "no room for the result",
                                    "an error of an unknown kind",
                                    ""};
    for (size_t i = 0; i < 7; ++i) {
        CHECK(finished[i].failure == failures[i]);
        CHECK(!finished[i].was_cancelled);
    }
}

TEST_CASE("what goes wrong while a job is being cancelled is told")
{
    Jobs jobs;
    std::latch began{1};
    const Jobs::Number number = jobs.start("import", [&](ProgressReporter& reporter) -> Jobs::Completion {
        began.count_down();
        while (!reporter.stop_requested()) std::this_thread::yield();
        fail("p.part: cannot be removed");
    });
    began.wait();
    jobs.cancel(number);
    const std::vector<Jobs::Finished> finished = jobs.wait();
    REQUIRE(finished.size() == 1);
    CHECK(finished[0].was_cancelled);
    CHECK(finished[0].failure == "p.part: cannot be removed");
}

TEST_CASE("a completion may start and cancel jobs")
{
    Jobs jobs;
    int steps = 0;
    const std::function<void()> next = [&] {
        if (++steps < 5) jobs.start("next", [&](ProgressReporter&) { return next; });
        jobs.cancel(jobs.start("never", [](ProgressReporter&) -> Jobs::Completion { return [] { FAIL("ran"); }; }));
    };
    jobs.start("first", [&](ProgressReporter&) { return next; });
    const std::vector<Jobs::Finished> finished = jobs.wait();
    CHECK(steps == 5);
    CHECK(finished.size() == 10);
}

TEST_CASE("closing cancels what runs and waits, completes nothing, and lets go of everything here")
{
    const auto held = std::make_shared<int>(7);
    Gate gate;
    {
        Jobs jobs;
        jobs.start("running", [run = gate.job(), held](ProgressReporter& reporter) { return run(reporter); });
        for (int i = 0; i < 5; ++i)
            jobs.start("waiting", [held](ProgressReporter&) -> Jobs::Completion { return [held] { FAIL("ran"); }; });
        gate.began.wait();
    }
    CHECK(held.use_count() == 1);
    const Jobs unused;
    CHECK(unused.is_idle());
}

TEST_CASE("functions and completions are destroyed where the jobs belong")
{
    struct Watched {
        std::thread::id here = std::this_thread::get_id();
        ~Watched() { CHECK(std::this_thread::get_id() == here); }
    };
    Jobs jobs;
    for (const bool fails : {false, true})
        jobs.start("job",
                   [watched = std::make_shared<Watched>(), fails](ProgressReporter&) mutable -> Jobs::Completion {
                       if (fails) fail("nothing");
                       return [taken = std::move(watched)] {};
                   });
    CHECK(jobs.wait().size() == 2);
}

TEST_CASE("1000 random starts, cancels and looks leave every job ended once, and completed unless it was cancelled")
{
    for (const uint32_t seed : {1u, 2u, 3u}) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        Jobs jobs;
        std::map<Jobs::Number, int> completed, ended, cancelled;
        std::vector<Jobs::Number> started;
        const auto take = [&](const std::vector<Jobs::Finished>& finished) {
            for (const Jobs::Finished& each : finished) {
                ++ended[each.number];
                CHECK(each.failure == "");
                CHECK((completed[each.number] == 1) == !each.was_cancelled);
                if (each.was_cancelled) CHECK(cancelled[each.number] > 0);
            }
        };
        for (int step = 0; step < 1000; ++step) {
            const uint32_t choice = random() % 8;
            if (choice < 4) {
                const uint32_t turns = random() % 64;
                const Jobs::Number expected = started.size() + 1;
                started.push_back(
                    jobs.start("job", [&, turns, expected](ProgressReporter& reporter) -> Jobs::Completion {
                        const Progress progress = reporter.begin("turning");
                        for (uint32_t i = 0; i < turns; ++i) progress(double(i) / turns);
                        return [&, expected] { ++completed[expected]; };
                    }));
                CHECK(started.back() == expected);
            } else if (choice < 6 && !started.empty()) {
                const Jobs::Number number = started[random() % started.size()];
                jobs.cancel(number);
                ++cancelled[number];
            } else if (choice == 6) {
                take(jobs.finish());
            } else {
                const std::vector<Jobs::State> states = jobs.states();
                for (size_t i = 1; i < states.size(); ++i) CHECK(states[i - 1].number < states[i].number);
            }
        }
        take(jobs.wait());
        CHECK(ended.size() == started.size());
        for (const auto& [number, count] : ended) CHECK(count == 1);
    }
}
