#include "haptics/inverse3/websocket_frame.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <utility>

#include "engine/base/error.h"

namespace shvr {
namespace {

constexpr size_t MAX_HEADER = 8 << 10;
constexpr uint8_t FINAL = 0x80, RESERVED = 0x70, MASKED = 0x80;
constexpr size_t MAX_CONTROL_PAYLOAD = 125;

// ---- SHA-1 and base64, only for the handshake: they show that the peer speaks WebSocket, and protect
// no secret -------------------------------------------------------------------------------------------

using Digest = std::array<uint32_t, 5>;

void add_block(Digest& digest, std::string_view block)
{
    std::array<uint32_t, 80> words{};
    for (size_t i = 0; i < 64; ++i) words[i / 4] |= uint32_t(uint8_t(block[i])) << (24 - 8 * (i % 4));
    for (size_t i = 16; i < 80; ++i)
        words[i] = std::rotl(words[i - 3] ^ words[i - 8] ^ words[i - 14] ^ words[i - 16], 1);
    auto [a, b, c, d, e] = digest;
    for (size_t i = 0; i < 80; ++i) {
        const auto [f, k] = i < 20   ? std::pair((b & c) | (~b & d), 0x5a827999u)
                            : i < 40 ? std::pair(b ^ c ^ d, 0x6ed9eba1u)
                            : i < 60 ? std::pair((b & c) | (b & d) | (c & d), 0x8f1bbcdcu)
                                     : std::pair(b ^ c ^ d, 0xca62c1d6u);
        const uint32_t sum = std::rotl(a, 5) + f + e + k + words[i];
        e = std::exchange(d, std::exchange(c, std::rotl(std::exchange(b, std::exchange(a, sum)), 30)));
    }
    const Digest change{a, b, c, d, e};
    for (size_t i = 0; i < 5; ++i) digest[i] += change[i];
}

std::array<uint8_t, 20> sha1(std::string_view text)
{
    std::string padded(text);
    padded += char(0x80);
    while (padded.size() % 64 != 56) padded += char(0);
    for (int shift = 56; shift >= 0; shift -= 8) padded += char(uint64_t{text.size()} * 8 >> shift);
    Digest digest{0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476, 0xc3d2e1f0};
    for (size_t at = 0; at < padded.size(); at += 64) add_block(digest, std::string_view(padded).substr(at, 64));
    std::array<uint8_t, 20> bytes{};
    for (size_t i = 0; i < 20; ++i) bytes[i] = uint8_t(digest[i / 4] >> (24 - 8 * (i % 4)));
    return bytes;
}

std::string base64(std::span<const uint8_t> bytes)
{
    constexpr std::string_view DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t at = 0; at < bytes.size(); at += 3) {
        const size_t count = std::min<size_t>(bytes.size() - at, 3);
        uint32_t bits = 0;
        for (size_t i = 0; i < count; ++i) bits |= uint32_t(bytes[at + i]) << (16 - 8 * i);
        for (size_t i = 0; i < 4; ++i) text += i <= count ? DIGITS[bits >> (18 - 6 * i) & 63] : '=';
    }
    return text;
}

bool is_same_word(std::string_view a, std::string_view b)
{
    return std::ranges::equal(
        a, b, {}, [](char c) { return std::tolower(uint8_t(c)); }, [](char c) { return std::tolower(uint8_t(c)); });
}

/// Returns the value of a header line; empty if there is none.
std::string_view header_value(std::string_view header, std::string_view name)
{
    while (!header.empty()) {
        const size_t end = std::min(header.find("\r\n"), header.size());
        const std::string_view line = header.substr(0, end);
        const size_t colon = line.find(':');
        if (colon != std::string_view::npos && is_same_word(line.substr(0, colon), name)) {
            const size_t first = line.find_first_not_of(" \t", colon + 1);
            const size_t last = line.find_last_not_of(" \t");
            return first == std::string_view::npos ? std::string_view{} : line.substr(first, last + 1 - first);
        }
        header.remove_prefix(std::min(end + 2, header.size()));
    }
    return {};
}

/// Appends the bytes before a payload: the opcode, and the length in the shortest of its three forms.
void append_frame_head(std::string& bytes, WebSocketOpcode opcode, size_t size, uint8_t mask_bit)
{
    bytes += char(FINAL | uint8_t(opcode));
    if (size <= MAX_CONTROL_PAYLOAD) {
        bytes += char(mask_bit | uint8_t(size));
        return;
    }
    const bool is_short = size <= 0xffff;
    bytes += char(mask_bit | (is_short ? 126 : 127));
    for (int shift = is_short ? 8 : 56; shift >= 0; shift -= 8) bytes += char(uint64_t{size} >> shift);
}

}  // namespace

std::string websocket_key(const std::array<uint8_t, 16>& random)
{
    return base64(random);
}

std::string websocket_accept(std::string_view key)
{
    return base64(sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));  // RFC 6455, 1.3
}

std::string websocket_request(uint16_t port, std::string_view key)
{
    return sentence("GET / HTTP/1.1\r\nHost: localhost:", port,
                    "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: ", key,
                    "\r\nSec-WebSocket-Version: 13\r\n\r\n");
}

WebSocketAnswer check_websocket_answer(std::string_view received, std::string_view key)
{
    const size_t end = received.find("\r\n\r\n");
    if (end == std::string_view::npos) {
        const bool is_too_long = received.size() > MAX_HEADER;
        return {.is_complete = is_too_long, .trouble = is_too_long ? "its answer has no end" : nullptr};
    }
    WebSocketAnswer answer{.is_complete = true, .size = end + 4};
    const std::string_view header = received.substr(0, end);
    if (!header.starts_with("HTTP/1.1 101 "))
        answer.trouble = "it does not switch to WebSocket";
    else if (header_value(header, "Sec-WebSocket-Accept") != websocket_accept(key))
        answer.trouble = "its handshake has the wrong key";
    return answer;
}

void append_websocket_frame(std::string& bytes, WebSocketOpcode opcode, std::string_view payload, uint32_t mask)
{
    append_frame_head(bytes, opcode, payload.size(), MASKED);
    for (int shift = 24; shift >= 0; shift -= 8) bytes += char(mask >> shift);
    for (size_t i = 0; i < payload.size(); ++i)
        bytes += char(uint8_t(payload[i]) ^ uint8_t(mask >> (24 - 8 * (i % 4))));
}

void append_unmasked_websocket_frame(std::string& bytes, WebSocketOpcode opcode, std::string_view payload)
{
    append_frame_head(bytes, opcode, payload.size(), 0);
    bytes += payload;
}

WebSocketReader::Event WebSocketReader::refuse(const char* why)
{
    trouble_ = why;
    received_.clear();
    used_ = 0;
    return Event::refused;
}

WebSocketReader::Event WebSocketReader::take_data(bool is_continuation, bool is_last)
{
    if (is_continuation != is_within_message_)
        return refuse(is_continuation ? "a part of a message without its beginning"
                                      : "a message begins before the last one ended");
    if (message_.size() + payload_.size() > MAX_WEBSOCKET_MESSAGE) return refuse("a message of more than 256 KiB");
    message_ += payload_;
    is_within_message_ = !is_last;
    if (!is_last) return Event::none;
    payload_ = std::exchange(message_, {});
    return Event::text;
}

WebSocketReader::Event WebSocketReader::next()
{
    while (!trouble_) {
        const std::string_view rest = std::string_view(received_).substr(used_);
        const auto byte = [&](size_t at) { return uint8_t(rest[at]); };
        if (rest.size() < 2) break;
        const uint8_t kind = byte(0) & 15;
        const bool is_last = byte(0) & FINAL, is_masked = byte(1) & MASKED;
        if (byte(0) & RESERVED) return refuse("a frame with reserved bits");
        if (is_masked != is_server_) return refuse("a frame that is masked the wrong way");

        const size_t form = byte(1) & 127;
        const size_t length_bytes = form == 126 ? 2 : form == 127 ? 8 : 0;
        const size_t head = 2 + length_bytes + (is_masked ? 4 : 0);
        if (rest.size() < head) break;
        uint64_t size = length_bytes == 0 ? form : 0;
        for (size_t i = 0; i < length_bytes; ++i) size = size << 8 | byte(2 + i);
        if (size > MAX_WEBSOCKET_MESSAGE) return refuse("a message of more than 256 KiB");
        const bool is_control = kind >= uint8_t(WebSocketOpcode::close);
        if (is_control && (!is_last || size > MAX_CONTROL_PAYLOAD)) return refuse("a control frame that is too long");
        if (rest.size() < head + size) break;

        payload_.assign(rest.substr(head, size_t(size)));
        for (size_t i = 0; is_masked && i < payload_.size(); ++i)
            payload_[i] = char(uint8_t(payload_[i]) ^ byte(head - 4 + i % 4));
        used_ += head + size_t(size);
        if (used_ > MAX_WEBSOCKET_MESSAGE || used_ == received_.size()) {
            received_.erase(0, used_);
            used_ = 0;
        }

        switch (WebSocketOpcode(kind)) {
            case WebSocketOpcode::text:
            case WebSocketOpcode::continuation:
                if (const Event event = take_data(kind == 0, is_last); event != Event::none) return event;
                break;
            case WebSocketOpcode::close: return Event::close;
            case WebSocketOpcode::ping: return Event::ping;
            case WebSocketOpcode::pong: break;
            default: return refuse("a frame of an unknown kind");
        }
    }
    return trouble_ ? Event::refused : Event::none;
}

}  // namespace shvr
