// Recordings of raw reports.

#include "haptics/hid/hid_recording.h"

#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    accepts([&] {
        const HidRecording recording = parse_hid_recording(std::string(text_of({data, size})), "recording");
        const HidRecording again = parse_hid_recording(text_of(recording), "again");
        expect(again.reports.size() == recording.reports.size(), "reports that get lost");
        for (size_t i = 0; i < again.reports.size(); ++i) {
            expect(again.reports[i].bytes == recording.reports[i].bytes, "other bytes");
            expect(i == 0 || again.reports[i].t_us >= again.reports[i - 1].t_us, "times that go back");
        }
    });
    return 0;
}
