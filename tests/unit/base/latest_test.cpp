#include "engine/base/latest.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include <doctest/doctest.h>

using namespace shvr;

TEST_CASE("nothing is taken before something is published")
{
    Latest<int> latest;
    CHECK_FALSE(latest.take());
    CHECK(latest.value() == 0);
}

TEST_CASE("the last published value is taken, once")
{
    Latest<int> latest;
    for (int i = 1; i <= 5; ++i) latest.publish(i);
    CHECK(latest.take());
    CHECK(latest.value() == 5);
    CHECK_FALSE(latest.take());
    CHECK(latest.value() == 5);
}

TEST_CASE("a taken value stays as it is while others are published")
{
    Latest<int> latest;
    latest.publish(1);
    latest.take();
    for (int i = 2; i <= 10; ++i) {
        latest.publish(i);
        CHECK(latest.value() == 1);
    }
    CHECK(latest.take());
    CHECK(latest.value() == 10);
}

TEST_CASE("between two threads values are whole, never go back, and the last one arrives")
{
    // Every word holds the same count: a torn value would hold two.
    struct Value {
        std::array<uint64_t, 32> words{};
    };
    constexpr uint64_t MIN_TAKEN = 2'000;
    Latest<Value> latest;
    std::atomic<uint64_t> taken{0}, last_published{0};
    std::thread writer([&] {
        uint64_t i = 0;
        for (; i < 10 * MIN_TAKEN || taken < MIN_TAKEN; ++i) {
            latest.writing().words.fill(i + 1);
            latest.publish();
            if (i % 16 == 0) std::this_thread::yield();  // the two may share a core
        }
        last_published = i;
    });
    uint64_t torn = 0, backward = 0, last = 0;
    while (last_published == 0 || last != last_published) {
        if (!latest.take()) {
            std::this_thread::yield();
            continue;
        }
        ++taken;
        const Value& value = latest.value();
        for (const uint64_t word : value.words) torn += word != value.words[0] ? 1 : 0;
        backward += value.words[0] <= last ? 1 : 0;
        last = value.words[0];
    }
    writer.join();
    CHECK(torn == 0);
    CHECK(backward == 0);
    CHECK_FALSE(latest.take());
    MESSAGE(taken.load(), " of ", last, " values were taken");
}
