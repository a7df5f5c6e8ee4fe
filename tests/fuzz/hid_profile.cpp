// Profiles of haptic devices, and with each a few reports.

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "haptics/hid/hid_profile.h"
#include "haptics/hid/hid_protocol.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    HidProfile profile;
    if (!accepts([&] { profile = parse_hid_profile(std::string(text_of({data, size})), "profile"); })) return 0;
    for (const uint8_t fill : std::array<uint8_t, 4>{0x00, 0x7f, 0x80, 0xff}) {
        std::array<uint8_t, 1 + MAX_REPORT_BYTES> report{};
        report.fill(fill);
        std::vector<HidReport> layouts = profile.inputs;
        if (profile.feature) layouts.push_back(*profile.feature);
        for (const HidReport& layout : layouts) {
            report[0] = layout.id;
            const std::span<const uint8_t> bytes(report.data(), layout.length + (layout.id == 0 ? 0 : 1));
            if (const std::optional<HidInput> input = decode(profile, bytes); input && input->rate && profile.rate) {
                const double speed = glm::length(shaped(*profile.rate, *input->rate));
                expect(speed <= 1.0 + 1e-12, "a speed above the full one");
            }
            decode_feature(profile, bytes);
        }
        const HidBytes sent = encode(profile, glm::dvec3(1e300 * (fill - 100.0), NAN, -1.0), fill, true);
        expect(sent.size <= sent.bytes.size(), "a report that is too long");
    }
    return 0;
}
