#pragma once
// A lock for GDCM, which keeps process-wide state. For the files of this folder that call it.

#include <gdcmTrace.h>

#include <cstdio>
#include <mutex>
#include <ostream>

namespace shvr {

/// Hold this lock while GDCM runs. It also silences GDCM, which would write to standard error, and its decoders, which
/// write to C's `stderr`: `stderr` is redirected to /dev/null meanwhile (the GNU C library allows assigning it; file
/// descriptor 2, which sanitizers and C++ use, is left alone).
class GdcmTurn {
public:
    GdcmTurn() : lock_(mutex())
    {
        static std::FILE* const silence = std::fopen("/dev/null", "we");
        if (silence != nullptr) stderr = silence;
        static std::ostream nowhere(nullptr);
        static const bool once = [] {
            gdcm::Trace::SetStream(nowhere);
            gdcm::Trace::DebugOff();
            gdcm::Trace::WarningOff();
            gdcm::Trace::ErrorOff();
            return true;
        }();
        static_cast<void>(once);
    }
    GdcmTurn(const GdcmTurn&) = delete;
    ~GdcmTurn() { stderr = kept_; }

private:
    static std::mutex& mutex()
    {
        static std::mutex mutex;
        return mutex;
    }
    std::lock_guard<std::mutex> lock_;
    std::FILE* kept_ = stderr;
};

}  // namespace shvr
