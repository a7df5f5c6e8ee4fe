#pragma once
// The Inverse3's link at 1 kHz against the stand-in for its service: message counts and latencies.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "haptics/inverse3/inverse3_link.h"
#include "tests/support/inverse3_service.h"

namespace shvr {

inline Inverse3Options options_for(const Inverse3Service& service)
{
    return {.port = service.port(),
            .event_port = service.event_port(),
            .allow_force = true,
            .realtime = false,
            .connect_timeout = std::chrono::seconds(3)};  // long enough for a busy machine
}

/// Latencies from a write to the state that answers it, in microseconds, sorted.
struct Pace {
    std::vector<double> added_us;
    Inverse3Counts counts;
    uint64_t ticks = 0, fresh = 0, heard = 0;
};

/// Writes once a millisecond, on the caller's thread, and spins for the answer until the next one is due.
inline Pace pace_of(int ticks)
{
    using Clock = std::chrono::steady_clock;
    Inverse3Service service;
    Pace pace;
    {
        const auto device = open_inverse3(options_for(service));
        REQUIRE(device);
        DeviceState state;
        uint32_t last = 0;
        Clock::time_point due = Clock::now();
        for (int tick = 1; tick <= ticks; ++tick) {
            due = std::max(due + std::chrono::milliseconds(1), Clock::now());
            std::this_thread::sleep_until(due);
            const Clock::time_point start = Clock::now();
            device->write({0.0, 0.0, 0.0}, uint32_t(tick));
            ++pace.ticks;
            while (Clock::now() < start + std::chrono::microseconds(950)) {
                if (device->read(state) != ReadResult::fresh) continue;
                CHECK(state.sequence > last);
                last = state.sequence;
                ++pace.fresh;
                pace.added_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
                break;
            }
        }
        // Messages in flight arrive.
        const Clock::time_point end = Clock::now() + std::chrono::seconds(10);
        while (Clock::now() < end && device->counts().sent != device->counts().answered)
            std::this_thread::sleep_for(std::chrono::microseconds(100));
        pace.counts = device->counts();
    }
    pace.heard = service.heard().size();
    std::ranges::sort(pace.added_us);
    return pace;
}

inline void check_pace(int ticks)
{
    const Pace pace = pace_of(ticks);
    CHECK(pace.ticks == uint64_t(ticks));
    CHECK(pace.counts.sent >= pace.fresh);
    CHECK(pace.counts.refused == 0);
    CHECK(pace.counts.connections == 1);
    CHECK(pace.counts.sent == pace.counts.answered);  // no message was lost
    CHECK(pace.heard >= pace.counts.sent);            // the last ones end the force
    REQUIRE_FALSE(pace.added_us.empty());
    const auto at = [&](double share) { return pace.added_us[size_t(share * double(pace.added_us.size() - 1))]; };
    MESSAGE(pace.counts.sent, " messages for ", ticks, " writes, ", pace.counts.answered, " answers; added time p50 ",
            at(0.5), " us, p99 ", at(0.99), " us, p99.9 ", at(0.999), " us");
}

}  // namespace shvr
