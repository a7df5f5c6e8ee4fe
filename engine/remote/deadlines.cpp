#include "engine/remote/deadlines.h"

#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

double seconds_from(const char* variable, double standard)
{
    constexpr double MOST = 86400.0;
    const char* const text = std::getenv(variable);
    if (text == nullptr || *text == '\0') return standard;
    const std::optional<double> seconds = number_of(text);
    if (!seconds || !(*seconds >= 1.0) || !(*seconds <= MOST))
        fail("environment variable ", variable, " is ", in_quotes(text), "; expected 1 to ", MOST, " seconds");
    return *seconds;
}

int64_t tries_from(const char* variable, int64_t standard)
{
    constexpr int64_t MOST = 100;
    const char* const text = std::getenv(variable);
    if (text == nullptr || *text == '\0') return standard;
    const std::optional<int64_t> tries = whole_of(text);
    if (!tries || *tries < 1 || *tries > MOST)
        fail("environment variable ", variable, " is ", in_quotes(text), "; expected 1 to ", MOST);
    return *tries;
}

}  // namespace

const Deadlines& deadlines()
{
    static const Deadlines read{.connect_s = seconds_from("SHVR_REMOTE_CONNECT_S", Deadlines{}.connect_s),
                                .stall_s = seconds_from("SHVR_REMOTE_STALL_S", Deadlines{}.stall_s),
                                .total_s = seconds_from("SHVR_REMOTE_TOTAL_S", Deadlines{}.total_s),
                                .tries = tries_from("SHVR_REMOTE_TRIES", Deadlines{}.tries)};
    return read;
}

}  // namespace shvr
