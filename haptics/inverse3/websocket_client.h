#pragma once
// A WebSocket to a port of the local machine. `connect` blocks for a limited time; after it, only `wait` blocks. A poll
// on `descriptor()` shows when data can be received. One thread at a time.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "haptics/inverse3/websocket_frame.h"

namespace shvr {

class WebSocketClient {
public:
    /// Returns null if nothing listens on the port, or if the listener is unusable; `trouble` then says why.
    static std::unique_ptr<WebSocketClient> connect(uint16_t port, std::chrono::milliseconds most,
                                                    std::string& trouble);
    ~WebSocketClient();
    WebSocketClient(const WebSocketClient&) = delete;
    WebSocketClient& operator=(const WebSocketClient&) = delete;

    int descriptor() const { return descriptor_; }
    /// Returns false if the peer is gone or has stopped reading.
    bool send_text(std::string_view text);
    /// Receives pending data; returns false if the connection has ended. Messages that were complete by then remain
    /// available through `next()`.
    bool receive();
    /// Returns the next message. Answers pings, several with one pong; returns `close` if a pong cannot be sent.
    WebSocketReader::Event next();
    std::string_view payload() const { return reader_.payload(); }
    const char* trouble() const { return reader_.trouble(); }
    /// Waits until data can be received. Returns false after `until`, even if data are ready by then.
    bool wait(std::chrono::steady_clock::time_point until) const;
    /// Announces that no more will be sent.
    void close();

private:
    explicit WebSocketClient(int descriptor) : descriptor_(descriptor) {}
    bool shake_hands(uint16_t port, std::chrono::steady_clock::time_point until, std::string& trouble);
    bool send_bytes(std::string_view bytes);
    bool send_frame(WebSocketOpcode opcode, std::string_view payload);

    int descriptor_;
    uint32_t mask_ = 0x9e3779b9;  ///< changes with each frame; not random, since masks only protect proxies
    std::string frame_;
    WebSocketReader reader_;
};

}  // namespace shvr
