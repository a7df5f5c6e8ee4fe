// Stylus traces, of every version. One that opens is written and read again, and what it holds is replayed through the
// servo's step: whatever it says, every force is a number within the device's limits.

#include "haptics/replay/replay.h"

#include <cmath>

#include "haptics/replay/trace_end.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

namespace {

using namespace shvr;
using namespace shvr::fuzz;

void check_replay(const Trace& trace, const ReplayOptions& options, const MakeRelevance& make)
{
    const ReplayResult result = replay_trace(trace, options, make, true);
    expect(result.steps.size() == trace.ticks.size(), "ticks that get lost");
    auto caps = trace.later_caps.begin();
    double most = trace.caps.peak_force_n;
    for (size_t i = 0; i < result.steps.size(); ++i) {
        for (; caps != trace.later_caps.end() && caps->from_tick <= i; ++caps) most = caps->caps.peak_force_n;
        const double force = glm::length(result.steps[i].force_n);
        expect(std::isfinite(force), "a force that is no number");
        // The last one may have been another device's.
        if (!options.touch) expect(force <= most + 1e-9, "a force above the device's");
    }
    expect(replay_trace(trace, options, make).hash == result.hash, "a replay that differs from itself");
}

void check(const std::string& text)
{
    accepts([&] {
        Trace trace = parse_trace(text, "trace");
        const std::string written = text_of(trace);
        expect(text_of(parse_trace(written, "again")) == written, "a trace that is not read as it was written");
        constexpr size_t FEW = 300;  // ticks are alike
        if (trace.ticks.size() > FEW) trace.ticks.resize(FEW);
        const MakeRelevance solid = [](const RegionWish& wish, double, RelevancePatch& patch) {
            patch.size = glm::ivec3(32);
            patch.volume_size = glm::ivec3(1 << 20);
            patch.words_per_row = 1;
            patch.spacing = glm::dvec3(wish.radius / 8.0);
            std::fill_n(patch.words.begin(), patch.word_count(), ~0u);
        };
        check_replay(trace, {}, solid);
        check_replay(trace, {.touch = TouchModel{}}, solid);
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    const std::string text(text_of({data, size}));
    check(text);
    // Changed bytes rarely come with their hash: the same lines with an end line that fits.
    const size_t end = text.rfind("{\"end\"");
    if (end != std::string::npos && end < 100'000) check(text.substr(0, end) + trace_end(text.substr(0, end)));
    return 0;
}
