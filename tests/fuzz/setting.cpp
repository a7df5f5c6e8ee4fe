// Arguments of --set, one per line; the last line also as the argument of --camera.

#include <algorithm>

#include "engine/session/session.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const std::string base =
        R"({"shvr_session": 1, "volume": {"procedural": "ramp"}, "transfer_function": {"points": []}})";
    std::vector<std::string> settings;
    // Settings come from the user's own command line and are quoted verbatim: only printable ones up to this length are
    // tried.
    constexpr size_t LONGEST = 300;
    std::string_view rest = text_of({data, size});
    while (!rest.empty() && settings.size() < 32) {
        const size_t end = std::min(rest.size(), rest.find('\n'));
        std::string setting(rest.substr(0, std::min(end, LONGEST)));
        std::replace_if(
            setting.begin(), setting.end(), [](char letter) { return (letter >= 0 && letter < ' ') || letter == 127; },
            ' ');
        settings.push_back(setting);
        rest.remove_prefix(std::min(rest.size(), end + 1));
    }
    Session session;
    if (accepts([&] { session = parse_session(base, input_folder().path(), "session", settings); })) {
        const std::string written = to_text(session, input_folder().path());
        expect(passes([&] { parse_session(written, input_folder().path(), "session"); }),
               "a session that cannot be read once written: " + last_outcome().refusal);
    }
    const VolumeInfo info{.size = Size3(5, 4, 3)};
    if (!settings.empty()) passes([&] { camera_named(session, settings.back(), info); });
    return 0;
}
