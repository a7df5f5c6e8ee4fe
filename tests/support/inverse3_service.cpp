#include "tests/support/inverse3_service.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "haptics/inverse3/websocket_frame.h"

namespace shvr {
namespace stand_in {

class Listener {
public:
    Listener() : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))
    {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* const raw = reinterpret_cast<sockaddr*>(&address);
        SHVR_CHECK(::bind(descriptor_, raw, size) == 0 && ::listen(descriptor_, 4) == 0);
        SHVR_CHECK(::getsockname(descriptor_, raw, &size) == 0);
        port_ = ntohs(address.sin_port);
    }
    ~Listener() { ::close(descriptor_); }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    int descriptor() const { return descriptor_; }
    uint16_t port() const { return port_; }

private:
    int descriptor_;
    uint16_t port_ = 0;
};

struct Client {
    int descriptor = -1;
    bool is_upgraded = false, is_first = true;
    std::string handshake;
    WebSocketReader reader{true};
};

void end(Client& client)
{
    if (client.descriptor >= 0) ::close(client.descriptor);
    client = {};
}

void send_all(const Client& client, const std::string& bytes)
{
    if (client.descriptor >= 0) [[maybe_unused]]
        const ssize_t sent = ::send(client.descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

void send_text(const Client& client, const std::string& text)
{
    std::string frame;
    append_unmasked_websocket_frame(frame, WebSocketOpcode::text, text);
    send_all(client, frame);
}

/// True when the client speaks WebSocket from now on.
bool shake_hands(Client& client, std::string_view bytes)
{
    client.handshake += bytes;
    const size_t end_of_header = client.handshake.find("\r\n\r\n");
    if (end_of_header == std::string::npos) return false;
    const std::string name = "Sec-WebSocket-Key: ";
    const size_t first = client.handshake.find(name) + name.size();
    const std::string key = client.handshake.substr(first, client.handshake.find("\r\n", first) - first);
    send_all(client,
             "HTTP/1.1 101 Switching Protocols\r\nupgrade: websocket\r\nConnection: Upgrade\r\n"
             "sec-websocket-accept: " +
                 websocket_accept(key) + "\r\n\r\n");
    client.is_upgraded = true;
    client.reader.add(std::string_view(client.handshake).substr(end_of_header + 4));
    return true;
}

glm::dvec3 force_of(const std::string& message)
{
    const auto vector = nlohmann::json::parse(message)["inverse3"][0]["commands"]["set_cursor_force"]["vector"];
    return {vector["x"].get<double>(), vector["y"].get<double>(), vector["z"].get<double>()};
}

}  // namespace stand_in

using namespace stand_in;

std::string inverse3_state_text(const glm::dvec3& position_m, const std::string& device_id)
{
    const auto vector = [](const glm::dvec3& v) { return nlohmann::json{{"x", v.x}, {"y", v.y}, {"z", v.z}}; };
    nlohmann::json state{{"cursor_position", vector(position_m)},
                         {"cursor_velocity", vector(glm::dvec3(0.0))},
                         {"angular_position", {{"a0", 0.5}, {"a1", 0.0}, {"a2", -1e-7}}},
                         {"control_mode", "idle"}};
    nlohmann::json document{
        {"inverse3", {{{"device_id", device_id}, {"config", {{"type", "inverse3"}}}, {"state", state}}}},
        {"wireless_verse_grip",
         {{{"device_id", "61576"},
           {"state",
            {{"orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
             {"buttons", {{"a", true}, {"b", false}}}}}}}}};
    return document.dump();
}

struct Inverse3Service::World {
    Listener states_door, events_door;
    mutable std::mutex mutex;
    std::function<std::string(const glm::dvec3&)> answer = [](const glm::dvec3&) {
        return inverse3_state_text(glm::dvec3(0.0));
    };
    std::string inventory = inverse3_state_text(glm::dvec3(0.0)), first_message;
    bool is_stalled = false;
    std::vector<glm::dvec3> owed;
    std::vector<Inverse3Heard> heard;
    Client states, events;
    std::atomic<bool> is_running{true};
    std::thread thread;

    void run()
    {
        while (is_running) {
            std::array<pollfd, 4> each{};
            {
                const std::lock_guard lock(mutex);
                each = {pollfd{states_door.descriptor(), POLLIN, 0}, pollfd{events_door.descriptor(), POLLIN, 0},
                        pollfd{states.descriptor, POLLIN, 0}, pollfd{events.descriptor, POLLIN, 0}};
            }
            ::poll(each.data(), each.size(), 1);
            const std::lock_guard lock(mutex);
            if (each[2].revents && each[2].fd == states.descriptor) take(states, true);
            if (each[3].revents && each[3].fd == events.descriptor) take(events, false);
            if (each[0].revents) {
                owed.clear();  // to the client before
                let_in(states, states_door);
            }
            if (each[1].revents) let_in(events, events_door);
            if (!is_stalled) {
                for (const glm::dvec3& force : std::exchange(owed, {})) send_text(states, answer(force));
            }
        }
    }
    static void let_in(Client& client, const Listener& door)
    {
        end(client);
        client.descriptor = ::accept4(door.descriptor(), nullptr, nullptr, SOCK_CLOEXEC);
        const int on = 1;
        ::setsockopt(client.descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
    void take(Client& client, bool has_states)
    {
        std::array<char, 16 << 10> bytes;
        const ssize_t count = ::recv(client.descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (count <= 0) {
            if (has_states) owed.clear();
            return end(client);
        }
        const std::string_view received(bytes.data(), size_t(count));
        if (client.is_upgraded)
            client.reader.add(received);
        else if (shake_hands(client, received) && has_states)
            send_text(client, inventory);
        while (client.is_upgraded && client.reader.next() == WebSocketReader::Event::text) {
            const std::string message(client.reader.payload());
            if (std::exchange(client.is_first, false)) first_message = message;
            heard.push_back({std::chrono::steady_clock::now(), force_of(message)});
            owed.push_back(heard.back().force_n);
        }
    }
};

Inverse3Service::Inverse3Service() : world_(std::make_unique<World>())
{
    world_->thread = std::thread(&World::run, world_.get());
}

Inverse3Service::~Inverse3Service()
{
    world_->is_running = false;
    world_->thread.join();
    end(world_->states);
    end(world_->events);
}

uint16_t Inverse3Service::port() const
{
    return world_->states_door.port();
}
uint16_t Inverse3Service::event_port() const
{
    return world_->events_door.port();
}

void Inverse3Service::set_inventory(const std::string& text)
{
    const std::lock_guard lock(world_->mutex);
    world_->inventory = text;
}

void Inverse3Service::set_answer(const std::function<std::string(const glm::dvec3&)>& answer)
{
    const std::lock_guard lock(world_->mutex);
    world_->answer = answer;
}

void Inverse3Service::set_stalled(bool is_stalled)
{
    const std::lock_guard lock(world_->mutex);
    world_->is_stalled = is_stalled;
}

void Inverse3Service::send_event(const std::string& text)
{
    const std::lock_guard lock(world_->mutex);
    send_text(world_->events, text);
}

void Inverse3Service::send_bytes(const std::string& bytes)
{
    const std::lock_guard lock(world_->mutex);
    send_all(world_->states, bytes);
}

void Inverse3Service::end_connections()
{
    const std::lock_guard lock(world_->mutex);
    end(world_->states);
    end(world_->events);
    world_->owed.clear();
}

void Inverse3Service::end_event_connections()
{
    const std::lock_guard lock(world_->mutex);
    end(world_->events);
}

bool Inverse3Service::has_clients() const
{
    const std::lock_guard lock(world_->mutex);
    return world_->states.is_upgraded && world_->events.is_upgraded;
}

std::vector<Inverse3Heard> Inverse3Service::heard() const
{
    const std::lock_guard lock(world_->mutex);
    return world_->heard;
}

std::string Inverse3Service::first_message() const
{
    const std::lock_guard lock(world_->mutex);
    return world_->first_message;
}

}  // namespace shvr
