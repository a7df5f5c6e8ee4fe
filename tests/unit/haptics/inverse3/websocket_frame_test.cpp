#include "haptics/inverse3/websocket_frame.h"

#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

using Event = WebSocketReader::Event;

std::string bytes_of(std::initializer_list<int> values)
{
    std::string bytes;
    for (const int value : values) bytes += char(value);
    return bytes;
}

/// The client's error for these bytes; empty if it reads them and waits for more.
std::string trouble_of(const std::string& bytes)
{
    WebSocketReader reader;
    reader.add(bytes);
    Event event = Event::none;
    while ((event = reader.next()) != Event::none && event != Event::refused) {
    }
    return event == Event::refused ? reader.trouble() : "";
}

}  // namespace

TEST_CASE("the handshake is that of RFC 6455, section 1.3")
{
    CHECK(websocket_accept("dGhlIHNhbXBsZSBub25jZQ==") == "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
    const std::string nonce = "the sample nonce";
    std::array<uint8_t, 16> random{};
    for (size_t i = 0; i < 16; ++i) random[i] = uint8_t(nonce[i]);
    CHECK(websocket_key(random) == "dGhlIHNhbXBsZSBub25jZQ==");
    CHECK(websocket_request(10001, "KEY").starts_with("GET / HTTP/1.1\r\nHost: localhost:10001\r\n"));

    const std::string good =
        "HTTP/1.1 101 Switching Protocols\r\nupgrade: websocket\r\n"
        "sec-websocket-accept:  s3pPLMBiTxaQ9kYGzzhZRbK+xOo= \r\n\r\n";
    const std::string key = "dGhlIHNhbXBsZSBub25jZQ==";
    for (size_t size = 0; size < good.size(); ++size)
        CHECK_FALSE(check_websocket_answer(good.substr(0, size), key).is_complete);
    const WebSocketAnswer answer = check_websocket_answer(good + "frame", key);
    CHECK(answer.is_complete);
    CHECK(answer.size == good.size());
    CHECK(answer.trouble == nullptr);
    CHECK(check_websocket_answer(good, "other key").trouble == std::string("its handshake has the wrong key"));
    CHECK(check_websocket_answer("HTTP/1.1 200 OK\r\n\r\n", key).trouble ==
          std::string("it does not switch to WebSocket"));
    CHECK(check_websocket_answer(std::string(10'000, 'x'), key).trouble == std::string("its answer has no end"));
}

TEST_CASE("frames are those of RFC 6455, section 5.7")
{
    std::string frame;
    append_unmasked_websocket_frame(frame, WebSocketOpcode::text, "Hello");
    CHECK(frame == bytes_of({0x81, 0x05, 0x48, 0x65, 0x6c, 0x6c, 0x6f}));
    frame.clear();
    append_websocket_frame(frame, WebSocketOpcode::text, "Hello", 0x37fa213d);
    CHECK(frame == bytes_of({0x81, 0x85, 0x37, 0xfa, 0x21, 0x3d, 0x7f, 0x9f, 0x4d, 0x51, 0x58}));

    WebSocketReader client, server(true);
    server.add(frame);
    CHECK(server.next() == Event::text);
    CHECK(server.payload() == "Hello");
    client.add(bytes_of({0x01, 0x03, 0x48, 0x65, 0x6c, 0x89, 0x02, 0x68, 0x69, 0x80, 0x02, 0x6c, 0x6f}));
    CHECK(client.next() == Event::ping);  // between the parts of a message
    CHECK(client.payload() == "hi");
    CHECK(client.next() == Event::text);
    CHECK(client.payload() == "Hello");
    CHECK(client.next() == Event::none);
}

TEST_CASE("messages of every size are read however they are cut")
{
    std::mt19937 random(7);
    std::string stream;
    std::vector<std::string> sent;
    for (const size_t size : {0u, 1u, 125u, 126u, 127u, 65'535u, 65'536u, 100'000u, 262'144u}) {
        std::string text(size, 0);
        for (char& c : text) c = char('a' + random() % 26);
        append_unmasked_websocket_frame(stream, WebSocketOpcode::text, text);
        sent.push_back(text);
    }
    for (const size_t step : {size_t{1}, size_t{1000}, size_t{70'001}, stream.size()}) {
        WebSocketReader reader;
        std::vector<std::string> got;
        for (size_t at = 0; at < stream.size(); at += step) {
            reader.add(std::string_view(stream).substr(at, step));
            while (reader.next() == Event::text) got.emplace_back(reader.payload());
        }
        CHECK(got == sent);
    }
}

TEST_CASE("what is against the protocol is refused, and nothing is read after it")
{
    CHECK(trouble_of(bytes_of({0x80, 0x01, 0x61})) == "a part of a message without its beginning");
    CHECK(trouble_of(bytes_of({0x01, 0x01, 0x61, 0x81, 0x01, 0x61})) == "a message begins before the last one ended");
    CHECK(trouble_of(bytes_of({0xc1, 0x00})) == "a frame with reserved bits");
    CHECK(trouble_of(bytes_of({0x81, 0x80, 0, 0, 0, 0})) == "a frame that is masked the wrong way");
    CHECK(trouble_of(bytes_of({0x83, 0x00})) == "a frame of an unknown kind");
    CHECK(trouble_of(bytes_of({0x82, 0x00})) == "a frame of an unknown kind");  // binary: the service sends text
    CHECK(trouble_of(bytes_of({0x09, 0x00})) == "a control frame that is too long");
    CHECK(trouble_of(bytes_of({0x89, 126, 0, 126})) == "a control frame that is too long");
    CHECK(trouble_of(bytes_of({0x81, 127, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff})) ==
          "a message of more than 256 KiB");
    std::string parts = bytes_of({0x01, 0x00});
    for (int i = 0; i < 5; ++i) {
        parts += bytes_of({0x00, 127, 0, 0, 0, 0, 0, 1, 0, 0});
        parts += std::string(65'536, 'a');
    }
    CHECK(trouble_of(parts) == "a message of more than 256 KiB");

    WebSocketReader reader;
    reader.add(bytes_of({0x83, 0x00}));
    CHECK(reader.next() == Event::refused);
    reader.add(bytes_of({0x81, 0x00}));
    CHECK(reader.next() == Event::refused);
}
