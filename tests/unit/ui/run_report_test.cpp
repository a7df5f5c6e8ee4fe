// The measurements of a run: times from an event to the frame that shows it, and the median that panels show.

#include "ui/run_report.h"

#include <doctest/doctest.h>

using namespace shvr::ui;

TEST_CASE("the interface's time is the median of its last frames, not the last one")
{
    RunReport report;
    CHECK(report.recent_frame_ms() == 0.0);
    double now = 0.0;
    const auto frame = [&](uint64_t number, double ms) {
        report.presented({.number = number, .begun_s = now});
        now += 1e-3 * ms;
        report.done(number, now);
    };
    for (uint64_t number = 1; number <= 100; ++number) frame(number, 500.0);
    for (uint64_t number = 101; number <= 131; ++number) frame(number, 10.0);
    frame(132, 900.0);
    CHECK(report.recent_frame_ms() == doctest::Approx(10.0));
    CHECK(report.measured().frames == 132);
}

TEST_CASE("keys are answered, and first pictures there, when the frame that shows them is done")
{
    RunReport report;
    report.opened(1.0);
    report.asked(1.2);
    CHECK(report.has_unanswered());
    report.presented({.number = 1, .begun_s = 1.3});
    CHECK(!report.has_unanswered());
    report.presented({.number = 2, .begun_s = 1.4, .shows_picture = true});
    report.done(1, 1.5);
    REQUIRE(report.measured().input_ms.size() == 1);
    CHECK(report.measured().input_ms[0] == doctest::Approx(300.0));
    CHECK(!report.measured().first_picture_ms);
    report.done(2, 1.75);
    CHECK(report.measured().first_picture_ms.value_or(0.0) == doctest::Approx(750.0));
    CHECK(!report.measured().sharp_picture_ms);
    report.opened(2.0);
    CHECK(!report.measured().first_picture_ms);
}

TEST_CASE("what an interface frame takes itself is told apart from what it waited for")
{
    RunReport report;
    report.presented({.number = 1, .begun_s = 1.0, .waited_s = 0.03, .shows_picture = true});
    report.done(1, 1.05);
    report.presented({.number = 2, .begun_s = 2.0, .shows_picture = true, .shows_sharp_picture = true});
    report.done(2, 2.01);
    REQUIRE(report.measured().own_busy_ms.size() == 1);
    CHECK(report.measured().own_busy_ms[0] == doctest::Approx(20.0));
    REQUIRE(report.measured().own_idle_ms.size() == 1);
    CHECK(report.measured().own_idle_ms[0] == doctest::Approx(10.0));
    CHECK(report.measured().frame_ms.size() == 2);
}
