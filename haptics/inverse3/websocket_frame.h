#pragma once
// The part of the WebSocket protocol (RFC 6455) needed by a client on the local machine: the texts of the handshake,
// and frames as bytes. Pure; any thread.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace shvr {

enum class WebSocketOpcode : uint8_t { continuation = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };

// ---- Handshake ----

/// Returns the key of a handshake: 16 random bytes in base64.
std::string websocket_key(const std::array<uint8_t, 16>& random);
/// Returns the answer that a server must give to `key`.
std::string websocket_accept(std::string_view key);
std::string websocket_request(uint16_t port, std::string_view key);

struct WebSocketAnswer {
    bool is_complete = false;       ///< the header has ended
    size_t size = 0;                ///< size of the header in bytes; the first frame follows the header
    const char* trouble = nullptr;  ///< reason why the peer is no WebSocket server; null: it is one
};
WebSocketAnswer check_websocket_answer(std::string_view received, std::string_view key);

// ---- Frames ----

inline constexpr size_t MAX_WEBSOCKET_MESSAGE = 256 << 10;  ///< limit; an inventory of several devices has about 10 KiB

/// Appends one whole frame, masked as RFC 6455 requires of clients.
void append_websocket_frame(std::string& bytes, WebSocketOpcode opcode, std::string_view payload, uint32_t mask);
/// Appends a frame without a mask, as servers send it.
void append_unmasked_websocket_frame(std::string& bytes, WebSocketOpcode opcode, std::string_view payload);

/// Splits received bytes into messages.
///
///     reader.add(bytes);
///     for (auto event = reader.next(); event != Event::none; event = reader.next()) ... reader.payload() ...
class WebSocketReader {
public:
    enum class Event : uint8_t {
        none,     ///< more bytes are needed
        text,     ///< a whole message
        ping,     ///< the caller must answer with a pong of the same payload
        close,    ///< the other side ends the connection
        refused,  ///< protocol violation: `trouble()` says why; nothing is read from then on
    };
    /// Servers receive masked frames, clients unmasked ones.
    explicit WebSocketReader(bool is_server = false) : is_server_(is_server) {}
    void add(std::string_view bytes) { received_.append(bytes); }
    Event next();
    /// The payload of the last event; valid until the next call of any method.
    std::string_view payload() const { return payload_; }
    const char* trouble() const { return trouble_; }

private:
    Event refuse(const char* why);
    Event take_data(bool is_continuation, bool is_last);

    bool is_server_;
    std::string received_, message_;
    size_t used_ = 0;  ///< number of bytes of `received_` already parsed
    bool is_within_message_ = false;
    std::string payload_;
    const char* trouble_ = nullptr;
};

}  // namespace shvr
