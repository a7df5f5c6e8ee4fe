#include "engine/annotation/script/log_time.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "engine/base/error.h"

namespace shvr {

int64_t wall_clock_ms()
{
    using namespace std::chrono;
    return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
}

std::string utc_text(int64_t time_ms)
{
    using namespace std::chrono;
    constexpr int64_t YEAR_0 = -62167219200000, YEAR_10000 = 253402300800000;
    const sys_time<milliseconds> time(milliseconds(std::clamp(time_ms, YEAR_0, YEAR_10000 - 1)));
    const auto day = floor<days>(time);
    const year_month_day date(day);
    const hh_mm_ss<milliseconds> clock(time - day);
    char text[40];
    std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", int(date.year()), unsigned(date.month()),
                  unsigned(date.day()), int(clock.hours().count()), int(clock.minutes().count()),
                  int(clock.seconds().count()), int(clock.subseconds().count()));
    return text;
}

std::string with_time(std::string line, int64_t time_ms)
{
    SHVR_CHECK(line.size() > 2 && line.back() == '}', line);
    line.pop_back();
    return line + ",\"time\":\"" + utc_text(time_ms) + "\"}";
}

}  // namespace shvr
