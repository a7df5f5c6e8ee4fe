// The parameters of a procedural volume, as a session states them.

#include "engine/session/session.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"
#include "tests/fuzz/support/volume_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    const std::string text = "{\"shvr_session\": 1, \"volume\": " + std::string(text_of({data, size})) + "}";
    Session session;
    if (!accepts([&] { session = parse_session(text, input_folder().path(), "session"); })) return 0;
    if (!session.procedural) return 0;
    std::unique_ptr<VolumeSource> source;
    if (passes([&] { source = open_source(session); })) try_source(*source);
    return 0;
}
