// Bytes from any program on the port of the Inverse3's service: handshake, frames, and the messages in them.

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "haptics/inverse3/inverse3_message.h"
#include "haptics/inverse3/websocket_frame.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

namespace {

/// Holds what is read against the header; returns what is wrong with the message.
const char* try_message(std::string_view text)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    Inverse3State state;
    const char* const wrong = read_inverse3_state(text, "", state);
    if (!wrong && !state.device_id.empty()) {
        expect(state.has_position, "a device without a place");
        for (int i = 0; i < 3; ++i) expect(std::abs(state.position_m[i]) <= 10.0, "a place that no device reaches");
        const double length = glm::length(state.rotation);
        expect(std::abs(length - 1.0) < 1e-9, "a rotation that is none");
        std::string command;
        append_inverse3_command(command, state.device_id, state.position_m, true);
        Inverse3State ignored;
        expect(read_inverse3_state(command, "", ignored) != nullptr, "a command taken for a state");
    }
    Inverse3Notice notice;
    const char* const no_notice = read_inverse3_notice(text, notice);
    return wrong ? wrong : no_notice;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    using Event = WebSocketReader::Event;
    const std::string_view bytes = text_of({data, size});
    const WebSocketAnswer answer = check_websocket_answer(bytes, "dGhlIHNhbXBsZSBub25jZQ==");
    expect(answer.size <= size, "a handshake that is longer than what came");
    try_message(bytes);
    accepts([&] {
        // However the bytes are cut, the messages are the same.
        size_t messages[2] = {0, 0};
        for (const size_t step : {size_t{1}, size_t{4096}}) {
            WebSocketReader reader;
            const char* wrong = nullptr;
            for (size_t at = 0; at < size && !wrong; at += step) {
                reader.add(bytes.substr(at, step));
                for (Event event = reader.next(); event != Event::none && !wrong; event = reader.next()) {
                    if (event == Event::refused) wrong = reader.trouble();
                    expect(reader.payload().size() <= MAX_WEBSOCKET_MESSAGE, "a message that is too long");
                    if (event != Event::text) continue;
                    ++messages[step == 1 ? 0 : 1];
                    wrong = try_message(reader.payload());
                }
            }
            if (step == 4096 && wrong) fail("the service: ", wrong);
            if (step == 4096 && messages[1] == 0) fail("the service: no message");
        }
        expect(messages[0] == messages[1], "messages that depend on how they are cut");
    });
    return 0;
}
