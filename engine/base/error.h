#pragma once
// Errors caused by the outside world, and checks for bugs in this program.
//
// `fail(...)` throws `Error` with one sentence: subject, value found, value expected. Only `main`, the boundary of a
// job and the application catch it. `SHVR_CHECK` asserts conditions that only a bug can violate; it also works in
// release builds, prints the claim and the values, and aborts. Any thread may call either.

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>

namespace shvr {

/// An error whose cause is outside the program: a file, an argument, a device. `what()` is one sentence for the user.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The command line was used wrongly (exit status 2).
class UsageError : public Error {
public:
    using Error::Error;
};

/// A comparison or gate has failed (exit status 3).
class GateError : public Error {
public:
    using Error::Error;
};

/// Joins its arguments as `operator<<` prints them.
template <class... Parts>
std::string sentence(const Parts&... parts)
{
    std::ostringstream text;
    static_cast<void>((text << ... << parts));
    return text.str();
}

template <class... Parts>
[[noreturn]] void fail(const Parts&... parts)
{
    throw Error(sentence(parts...));
}

[[noreturn]] inline void abort_on_failed_check(const char* claim, const char* file, int line, const std::string& values)
{
    std::fprintf(stderr, "%s:%d: SHVR_CHECK(%s) does not hold%s%s\n", file, line, claim, values.empty() ? "" : ": ",
                 values.c_str());
    std::abort();
}

}  // namespace shvr

/// SHVR_CHECK(claim, values...): aborts, printing the claim and the values, when the claim is false.
#define SHVR_CHECK(claim, ...)                                                                                         \
    do {                                                                                                               \
        if (!(claim)) ::shvr::abort_on_failed_check(#claim, __FILE__, __LINE__, ::shvr::sentence(__VA_ARGS__));        \
    } while (false)
