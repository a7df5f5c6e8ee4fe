#include "haptics/inverse3/websocket_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <random>

namespace shvr {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int MAX_RECEIVES = 4;  ///< 16 KiB per receive; bounded, so that a flood of messages cannot block sending

/// Returns false after `until`, even if data are ready: a peer that keeps sending bytes must not extend a deadline.
bool wait_for(int descriptor, short what, SteadyClock::time_point until)
{
    for (;;) {
        const auto rest = std::chrono::ceil<milliseconds>(until - SteadyClock::now());
        if (rest.count() <= 0) return false;
        pollfd each{.fd = descriptor, .events = what, .revents = 0};
        const int ready = ::poll(&each, 1, int(rest.count()));
        if (ready > 0) return true;
        if (ready == 0 || errno != EINTR) return false;
    }
}

/// Returns a connected socket, or -1.
int connect_socket(uint16_t port, SteadyClock::time_point until)
{
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor < 0) return -1;
    const int on = 1;
    ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);  // disables Nagle's algorithm: a force must not
                                                                         // wait for the next one
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool is_begun =
        ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EINPROGRESS;
    int error = 0;
    socklen_t size = sizeof error;
    const bool is_connected = is_begun && wait_for(descriptor, POLLOUT, until) &&
                              ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
    if (is_connected) return descriptor;
    ::close(descriptor);
    return -1;
}

}  // namespace

std::unique_ptr<WebSocketClient> WebSocketClient::connect(uint16_t port, milliseconds most, std::string& trouble)
{
    trouble.clear();
    const SteadyClock::time_point until = SteadyClock::now() + most;
    const int descriptor = connect_socket(port, until);
    if (descriptor < 0) return nullptr;
    std::unique_ptr<WebSocketClient> client(new WebSocketClient(descriptor));
    return client->shake_hands(port, until, trouble) ? std::move(client) : nullptr;
}

WebSocketClient::~WebSocketClient()
{
    ::close(descriptor_);
}

bool WebSocketClient::shake_hands(uint16_t port, SteadyClock::time_point until, std::string& trouble)
{
    std::random_device device;
    std::array<uint8_t, 16> random{};
    for (uint8_t& byte : random) byte = uint8_t(device());
    const std::string key = websocket_key(random);
    trouble = "it closes the connection";
    if (!send_bytes(websocket_request(port, key))) return false;
    std::string received;
    WebSocketAnswer answer;
    while (!answer.is_complete) {
        if (!wait(until)) {
            trouble = "it does not answer";
            return false;
        }
        std::array<char, 1024> bytes;
        const ssize_t count = ::recv(descriptor_, bytes.data(), bytes.size(), 0);
        if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
        if (count <= 0) return false;
        received.append(bytes.data(), size_t(count));
        answer = check_websocket_answer(received, key);
    }
    trouble = answer.trouble ? answer.trouble : "";
    if (!answer.trouble) reader_.add(std::string_view(received).substr(answer.size));
    return !answer.trouble;
}

bool WebSocketClient::send_bytes(std::string_view bytes)
{
    // An unsent message has a few hundred bytes at most, so a full send buffer means that the peer has stopped reading.
    ssize_t count = -1;
    do count = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    while (count < 0 && errno == EINTR);
    return count == ssize_t(bytes.size());
}

bool WebSocketClient::send_frame(WebSocketOpcode opcode, std::string_view payload)
{
    mask_ = mask_ * 1664525u + 1013904223u;
    frame_.clear();
    append_websocket_frame(frame_, opcode, payload, mask_);
    return send_bytes(frame_);
}

bool WebSocketClient::send_text(std::string_view text)
{
    return send_frame(WebSocketOpcode::text, text);
}

bool WebSocketClient::receive()
{
    std::array<char, 16 << 10> bytes;
    for (int i = 0; i < MAX_RECEIVES; ++i) {
        const ssize_t count = ::recv(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (count == 0) return false;
        if (count < 0) return errno == EAGAIN || errno == EINTR;
        reader_.add({bytes.data(), size_t(count)});
        if (size_t(count) < bytes.size()) return true;
    }
    return true;
}

WebSocketReader::Event WebSocketClient::next()
{
    // Of many pings, only the last gets a pong, as RFC 6455 (5.5.3) allows: a flood of pings causes no flood of pongs.
    std::optional<std::string> ping;
    WebSocketReader::Event event = reader_.next();
    for (; event == WebSocketReader::Event::ping; event = reader_.next()) ping = reader_.payload();
    // A partly sent pong would garble all later frames, so the connection is closed.
    if (ping && !send_frame(WebSocketOpcode::pong, *ping)) return WebSocketReader::Event::close;
    return event;
}

bool WebSocketClient::wait(SteadyClock::time_point until) const
{
    return wait_for(descriptor_, POLLIN, until);
}

void WebSocketClient::close()
{
    send_frame(WebSocketOpcode::close, {});
    ::shutdown(descriptor_, SHUT_WR);
}

}  // namespace shvr
