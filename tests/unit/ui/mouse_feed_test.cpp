#include "ui/mouse_feed.h"

#include <doctest/doctest.h>

using shvr::ui::MouseFeed;

namespace {

constexpr int LEFT = 0, RIGHT = 1;
const glm::dvec2 HERE(10.0, 20.0);

void click(MouseFeed& feed, int button, double time_s)
{
    feed.add(button, true, HERE, time_s, time_s);
    feed.add(button, false, HERE, time_s, time_s);
}

}  // namespace

TEST_CASE("two clicks within one frame are told to four frames, as a double click")
{
    MouseFeed feed;
    click(feed, LEFT, 1.0);
    click(feed, LEFT, 1.0);
    for (const bool is_second : {false, true}) {
        const MouseFeed::Frame pressed = feed.next();
        CHECK(pressed.down[LEFT]);
        CHECK(pressed.at == HERE);
        CHECK(pressed.is_double == is_second);
        CHECK(feed.is_waiting());
        CHECK_FALSE(feed.next().down[LEFT]);
    }
    CHECK_FALSE(feed.is_waiting());
    CHECK_FALSE(feed.next().at.has_value());
}

TEST_CASE("the time between clicks is that of the events, however long frames take")
{
    MouseFeed feed;
    click(feed, LEFT, 1.0);
    click(feed, LEFT, 1.0 + 0.99 * MouseFeed::DOUBLE_CLICK_S);
    click(feed, LEFT, 9.0);
    click(feed, LEFT, 9.0 + MouseFeed::DOUBLE_CLICK_S);
    for (const bool is_double : {false, true, false, false}) {
        CHECK(feed.next().is_double == is_double);
        feed.next();
    }
}

TEST_CASE("clicks of different buttons are no double click, and a held button stays down")
{
    MouseFeed feed;
    click(feed, LEFT, 1.0);
    feed.add(RIGHT, true, HERE, 1.1, 1.1);
    feed.add(7, true, HERE, 1.1, 1.1);
    feed.next();
    feed.next();
    CHECK_FALSE(feed.next().is_double);
    for (int frame = 0; frame < 3; ++frame) {
        CHECK_FALSE(feed.is_waiting());
        CHECK(feed.next().down[RIGHT]);
    }
    feed.add(RIGHT, false, HERE, 2.0, 2.0);
    CHECK_FALSE(feed.next().down[RIGHT]);
}

TEST_CASE("a click received after a long frame may have been made during it")
{
    MouseFeed feed;
    click(feed, LEFT, 1.0);
    feed.add(LEFT, true, HERE, 1.1, 2.5);
    feed.add(LEFT, false, HERE, 1.1, 2.5);
    feed.add(LEFT, true, HERE, 3.1, 3.2);
    feed.next();
    feed.next();
    CHECK(feed.next().is_double);
    feed.next();
    CHECK_FALSE(feed.next().is_double);
}
