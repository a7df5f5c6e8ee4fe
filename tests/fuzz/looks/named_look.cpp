// A file of a look: groups, light and a transfer function for any scan.

#include "engine/session/looks/named_look.h"

#include "tests/fuzz/support/attempt.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const std::string text(reinterpret_cast<const char*>(data), size);
    passes([&] { static_cast<void>(is_look(text, "look")); });
    NamedLook look;
    if (!accepts([&] { look = parse_look(text, "look", "look"); })) return 0;
    expect(look.curve.points.size() >= 2, "a curve of less than two points");
    const std::string written = text_of(look);
    expect(passes([&] { look = parse_look(written, "look", "look"); }),
           "a look that cannot be read once written: " + last_outcome().refusal);
    expect(text_of(look) == written, "another look than was written");
    VolumeStatistics statistics{.minimum = 0.0, .maximum = 255.0};
    statistics.histogram.assign(256, 10);
    passes([&] { static_cast<void>(with_look({}, look, statistics)); });
    return 0;
}
