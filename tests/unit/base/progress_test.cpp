#include "engine/base/progress.h"

#include <vector>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

/// A line with a clock that only this moves.
struct Shown {
    explicit Shown(bool is_terminal)
        : line({is_terminal, [this](const std::string& text) { written.push_back(text); }, [this] { return now; }})
    {}
    double now = 100.0;
    std::vector<std::string> written;
    ProgressLine line;
};

}  // namespace

TEST_CASE("work that is done within a second says nothing")
{
    for (const bool is_terminal : {false, true}) {
        Shown shown(is_terminal);
        shown.line.begin("measuring");
        for (int i = 0; i <= 9; ++i) {
            shown.now = 100.0 + 0.11 * i;
            shown.line.show(0.1 * i);
        }
        shown.line.clear();
        CHECK(shown.written.empty());
    }
}

TEST_CASE("elsewhere than on a terminal there is a line after a second, and then one every ten seconds at most")
{
    Shown shown(false);
    shown.line.begin("measuring");
    for (int tick = 0; tick <= 160; ++tick) {  // 40 s in steps of 1/4 s, at 1/64 a second
        shown.now = 100.0 + tick / 4.0;
        shown.line.show(tick / 256.0);
    }
    shown.line.clear();
    CHECK(shown.written == std::vector<std::string>{"measuring: 1 %, 1 min 3 s left\n", "measuring: 17 %, 53 s left\n",
                                                    "measuring: 32 %, 43 s left\n", "measuring: 48 %, 33 s left\n"});
}

TEST_CASE("the interval between lines holds over several stretches of work, whose time left is each their own")
{
    Shown shown(false);
    shown.line.begin("reading");
    shown.line.show(0.0);
    shown.now += 2.0;
    shown.line.show(0.5);
    shown.now += 2.0;
    shown.line.begin("drawing");
    shown.line.show(0.0);
    shown.now += 7.0;
    shown.line.show(0.25);  // 9 s after the line
    shown.now += 1.0;
    shown.line.show(0.25);
    CHECK(shown.written == std::vector<std::string>{"reading: 50 %, 2 s left\n", "drawing: 25 %, 24 s left\n"});
}

TEST_CASE("on a terminal one line is rewritten, at most ten times a second, and taken away at the end")
{
    Shown shown(true);
    shown.line.begin("drawing");
    for (int tick = 0; tick <= 150; ++tick) {  // 1.5 s in steps of 0.01 s
        shown.now = 100.0 + 0.01 * tick;
        shown.line.show(tick / 200.0);
    }
    REQUIRE(shown.written.size() >= 5);
    CHECK(shown.written.size() <= 6);
    for (const std::string& text : shown.written) {
        CHECK(text.starts_with("\r\x1b[Kdrawing: "));
        CHECK(text.find('\n') == std::string::npos);
    }
    shown.line.clear();
    CHECK(shown.written.back() == "\r\x1b[K");
    const size_t count = shown.written.size();
    shown.line.clear();
    CHECK(shown.written.size() == count);
}

TEST_CASE("work that goes on where an earlier run ended estimates by what this run did")
{
    Shown shown(false);
    shown.line.begin("importing");
    shown.line.show(0.8);
    shown.now += 10.0;
    shown.line.show(0.9, "12 MB/s");
    CHECK(shown.written == std::vector<std::string>{"importing: 90 %, 12 MB/s, 10 s left\n"});
}

TEST_CASE("of work whose end is not known the time is said")
{
    Shown shown(false);
    shown.line.begin("comparing");
    shown.line.show(-1.0);
    shown.now += 3.0;
    shown.line.show(-1.0);
    CHECK(shown.written == std::vector<std::string>{"comparing: 3 s so far\n"});
}

TEST_CASE("durations are rounded up and have at most two units")
{
    CHECK(duration_text(0.0) == "0 s");
    CHECK(duration_text(0.2) == "1 s");
    CHECK(duration_text(59.5) == "1 min 0 s");
    CHECK(duration_text(125.0) == "2 min 5 s");
    CHECK(duration_text(12000.0) == "3 h 20 min");
}

TEST_CASE("a part of the work tells its share of the whole, and nobody where nobody asks")
{
    double told = 0.0;
    const Progress whole = [&](double fraction) { told = fraction; };
    tell(part_of(whole, 0.5, 0.75), 0.5);
    CHECK(told == 0.625);
    CHECK(!part_of({}, 0.0, 1.0));
    tell({}, 0.5);
}
