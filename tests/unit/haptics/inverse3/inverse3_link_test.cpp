#include "haptics/inverse3/inverse3_link.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "haptics/force.h"
#include "haptics/inverse3/inverse3_message.h"
#include "haptics/inverse3/websocket_frame.h"
#include "haptics/simulated_device.h"
#include "tests/support/haptic_scenes.h"
#include "tests/support/inverse3_pace.h"

using namespace shvr;
using std::chrono::milliseconds;

namespace {

using Clock = std::chrono::steady_clock;

template <class Claim>
bool comes_true(const Claim& claim)
{
    const Clock::time_point end = Clock::now() + std::chrono::seconds(20);
    while (Clock::now() < end) {
        if (claim()) return true;
        std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
}

/// Writes like a servo until `claim` holds: a force of 1 N that is faded in again after each loss of the device.
template <class Claim>
bool pulls_until(HapticDevice& device, const Claim& claim)
{
    DeviceState state;
    return comes_true([&] {
        const bool is_lost = device.read(state) == ReadResult::lost;
        device.write({is_lost || !state.calibrated ? 0.0 : 1.0, 0.0, 0.0}, 1);
        return claim();
    });
}

/// The same by a servo that requests its 1 N whatever it reads: only the link takes the force back.
template <class Claim>
bool insists_until(HapticDevice& device, const Claim& claim)
{
    DeviceState state;
    return comes_true([&] {
        device.read(state);
        device.write({1.0, 0.0, 0.0}, 1);
        return claim();
    });
}

bool is_pulling(const Inverse3Service& service)
{
    const std::vector<Inverse3Heard> heard = service.heard();
    return !heard.empty() && heard.back().force_n.x == 1.0;
}

/// Milliseconds from `start` to the first zero force after it, after which no other force was heard; -1: none.
double zero_after_ms(const std::vector<Inverse3Heard>& heard, Clock::time_point start)
{
    double first_ms = -1.0;
    for (const Inverse3Heard& each : heard) {
        const double ms = std::chrono::duration<double, std::milli>(each.at - start).count();
        if (ms < 0.0) continue;
        if (each.force_n != glm::dvec3(0.0))
            first_ms = -1.0;
        else if (first_ms < 0.0)
            first_ms = ms;
    }
    return first_ms;
}

std::string safety_event(const std::string& type)
{
    return R"({"name":"device-safety-triggered","category":"device","level":"error","data":{"device_id":"049D",)"
           R"("safety_type":")" +
           type + R"("},"message":""})";
}

std::string frame_of(const std::string& text)
{
    std::string frame;
    append_unmasked_websocket_frame(frame, WebSocketOpcode::text, text);
    return frame;
}

/// Opens the device and pulls with 1 N.
std::unique_ptr<Inverse3> pulling(const Inverse3Service& service, Inverse3Options options)
{
    auto device = open_inverse3(options);
    REQUIRE(device);
    REQUIRE(pulls_until(*device, [&] { return is_pulling(service); }));
    CHECK(device->trouble() == std::string());
    return device;
}
std::unique_ptr<Inverse3> pulling(const Inverse3Service& service)
{
    return pulling(service, options_for(service));
}

std::atomic<uint64_t> virtual_ns{0};
constexpr milliseconds NEVER = std::chrono::hours(1);

}  // namespace

namespace {

/// Listens on a port of this machine, answers a handshake, and then sends the same bytes again and again.
class Flood {
public:
    explicit Flood(std::string bytes) : bytes_(std::move(bytes))
    {
        listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        REQUIRE(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) == 0);
        REQUIRE(::listen(listener_, 1) == 0);
        REQUIRE(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0);
        port_ = ntohs(address.sin_port);
        thread_ = std::thread(&Flood::run, this);
    }
    ~Flood()
    {
        ::shutdown(listener_, SHUT_RDWR);
        thread_.join();
        ::close(listener_);
    }
    uint16_t port() const { return port_; }

private:
    void run()
    {
        for (;;) {
            const int client = ::accept(listener_, nullptr, nullptr);
            if (client < 0) return;
            std::string request(4096, 0);
            request.resize(size_t(std::max<ssize_t>(::recv(client, request.data(), request.size(), 0), 0)));
            constexpr std::string_view NAME = "Sec-WebSocket-Key: ";
            const size_t at = request.find(NAME);
            const std::string key = at == std::string::npos
                                        ? ""
                                        : request.substr(at + NAME.size(), request.find("\r\n", at) - at - NAME.size());
            const std::string answer =
                "HTTP/1.1 101 Switching Protocols\r\nSec-WebSocket-Accept: " + websocket_accept(key) + "\r\n\r\n";
            bool is_open = ::send(client, answer.data(), answer.size(), MSG_NOSIGNAL) > 0;
            std::string unread(65536, 0);
            while (is_open) {  // until the client leaves
                is_open = ::send(client, bytes_.data(), bytes_.size(), MSG_NOSIGNAL) > 0;
                static_cast<void>(::recv(client, unread.data(), unread.size(), MSG_DONTWAIT));
            }
            ::close(client);
        }
    }

    std::string bytes_;
    int listener_ = -1;
    uint16_t port_ = 0;
    std::thread thread_;
};

std::string many_pings()
{
    std::string pings;
    for (int i = 0; i < 20'000; ++i) pings += std::string("\x89\0", 2);
    return pings;
}

}  // namespace

TEST_CASE("a peer that sends without end, and never what is expected, is given up at the deadline")
{
    // Pings, parts of a message that never ends, and frames that mean nothing.
    for (const std::string& bytes : {many_pings(), std::string(20'000, '\0'), std::string("\x8a\0", 2)}) {
        const Flood flood(bytes);
        const Inverse3Found found =
            find_inverse3({.port = flood.port(), .event_port = 1, .connect_timeout = milliseconds(50)});
        CHECK(found.is_service);
        CHECK(found.device_id.empty());
        CHECK(found.trouble != "");
    }
}

TEST_CASE("during a flood of pings the force is taken back, and that is shown")
{
    Inverse3Service service;
    const auto device = pulling(service);
    service.set_stalled(true);
    const Clock::time_point start = Clock::now();
    const std::string pings = many_pings();
    CHECK(insists_until(*device, [&] {
        service.send_bytes(pings);
        return zero_after_ms(service.heard(), start) >= 0.0;
    }));
    MESSAGE("zero force ", zero_after_ms(service.heard(), start), " ms after the last answer, among pings");
    CHECK(insists_until(*device, [&] {
        service.send_bytes(pings);
        return device->trouble() != std::string();
    }));
}

TEST_CASE("at 1 kHz for some seconds no message is lost")
{
    check_pace(3000);
}

TEST_CASE("through the socket the forces are those of the simulated device, bit for bit")
{
    const Rod rod{.point = {0.0, 20.0, 20.0}, .radius = 4.0};
    auto patch = std::make_unique<RelevancePatch>();
    fill_patch(*patch, {0, 0, 0}, {40, 40, 40}, glm::dvec3(1.0), [&](const glm::dvec3& p) { return rod.holds(p); });
    ForceSettings settings;
    settings.assistance = true;
    settings.probe_radius = 6.0;
    const glm::dvec3 middle = from_inverse3({0.0, -0.12, 0.15});  // of what the arm reaches
    settings.workspace = {.to_volume = glm::dmat3(1000.0), .origin = glm::dvec3(20.0) - 1000.0 * middle};
    const int ticks = 1500;
    const auto wish_at = [&](int tick) {
        const double t = tick * 1e-3;
        const glm::dvec3 beside(0.002 * t, 0.004 * std::sin(5.0 * t), 0.003 * std::cos(3.0 * t));
        return HandWish{.position_m = middle + beside, .jump = 1};
    };
    // The same hand and settings as an arm in its own right, and behind the service.
    const auto forces_of = [&](auto&& next_state, auto&& set_force, const DeviceCaps& caps) {
        ForceMemory memory;
        const auto growth = std::make_unique<GrowthMemory>();
        std::vector<glm::dvec3> forces;
        DeviceState state;
        for (int tick = 1; tick <= ticks; ++tick) {
            const uint64_t now_ns = uint64_t(tick) * 1'000'000;
            next_state(state, tick);
            patch->time_ns = now_ns;
            const ForceStep force = step(settings, caps, ReadResult::fresh, state, *patch, now_ns, memory, *growth);
            set_force(force.force_n, uint32_t(tick));
            forces.push_back(force.force_n);
        }
        return forces;
    };

    Inverse3Service service;
    Inverse3Options options = options_for(service);
    options.write_timeout = options.answer_timeout = options.keep_alive = std::chrono::hours(1);
    options.now_ns = [] { return virtual_ns.load(); };
    SimulatedDevice behind(MODELLED_HAND), alone(MODELLED_HAND);
    std::atomic<int> answers{0};
    service.set_answer([&](const glm::dvec3& force) {
        behind.write(from_inverse3(force), 1);
        behind.wish().publish(wish_at(++answers));
        DeviceState state;
        behind.read(state);
        return inverse3_state_text(to_inverse3(state.position_m));
    });
    const auto device = open_inverse3(options);
    REQUIRE(device);
    DeviceState first;
    CHECK(device->read(first) == ReadResult::lost);  // once, after each connection
    const DeviceCaps caps = device->caps();
    glm::dvec3 force(0.0);
    const std::vector<glm::dvec3> through = forces_of(
        [&](DeviceState& state, int tick) {
            virtual_ns = uint64_t(tick) * 1'000'000;
            device->write(force, uint32_t(tick - 1));  // the force of the tick before
            REQUIRE(comes_true([&] { return device->read(state) == ReadResult::fresh; }));
        },
        [&](const glm::dvec3& next, uint32_t) { force = next; }, caps);
    const std::vector<glm::dvec3> direct = forces_of(
        [&](DeviceState& state, int tick) {
            alone.wish().publish(wish_at(tick));
            alone.read(state);
            state.force_sequence = uint32_t(tick - 1);  // a link knows what it sent, and not what the arm delays
        },
        [&](const glm::dvec3& next, uint32_t tick) { alone.write(next, tick); }, caps);
    REQUIRE(through.size() == direct.size());
    int differences = 0, pulls = 0;
    for (size_t i = 0; i < direct.size(); ++i) {
        differences += through[i] != direct[i];
        pulls += glm::length(direct[i]) > 0.05;
    }
    CHECK(differences == 0);
    CHECK(pulls > 300);  // the trace is one with forces
    CHECK(answers == ticks);
}

TEST_CASE("the force is zero when the servo hangs, and is not simply there again when it goes on")
{
    Inverse3Service service;
    Inverse3Options options = options_for(service);
    options.answer_timeout = NEVER;  // on a busy machine it might bite first
    const auto device = pulling(service, options);
    CHECK(service.first_message().starts_with(R"({"session":{"configure":{"profile":{"name":"shvr"}}},)"));
    const Clock::time_point start = Clock::now();
    CHECK(comes_true([&] { return zero_after_ms(service.heard(), start) >= 0.0; }));
    MESSAGE("zero force ", zero_after_ms(service.heard(), start), " ms after the servo's last write");
    device->write({1.0, 0.0, 0.0}, 1);
    std::this_thread::sleep_for(milliseconds(5));
    CHECK_FALSE(is_pulling(service));
    DeviceState state;
    CHECK(device->read(state) == ReadResult::lost);
    CHECK(pulls_until(*device, [&] { return is_pulling(service); }));
}

TEST_CASE("the force is zero when the service does not answer")
{
    Inverse3Service service;
    Inverse3Options options = options_for(service);
    options.write_timeout = NEVER;
    const auto device = pulling(service, options);
    const Clock::time_point start = Clock::now();
    service.set_stalled(true);
    CHECK(insists_until(*device, [&] { return zero_after_ms(service.heard(), start) >= 0.0; }));
    MESSAGE("zero force ", zero_after_ms(service.heard(), start), " ms after the last answer");
    service.set_stalled(false);
    CHECK(pulls_until(*device, [&] { return is_pulling(service); }));
    CHECK(device->counts().connections == 1);
}

TEST_CASE("the force is zero after an event of safety and after a loss, whatever the servo wants")
{
    Inverse3Service service;
    Inverse3Options options = options_for(service);
    options.answer_timeout = options.write_timeout = NEVER;
    const auto device = pulling(service, options);
    const auto keeps_zero = [&](const char* what, Clock::time_point start) {
        CHECK(insists_until(*device, [&] { return zero_after_ms(service.heard(), start) >= 0.0; }));
        MESSAGE("zero force ", zero_after_ms(service.heard(), start), " ms after ", std::string(what));
    };

    SUBCASE("the emergency brake")
    {
        service.send_event(safety_event("ebrake_triggered"));
        keeps_zero("the e-brake", Clock::now());
        CHECK(std::string(device->trouble()).find("emergency brake") != std::string::npos);
        const size_t before = service.heard().size();
        CHECK(insists_until(*device, [&] { return service.heard().size() > before + 50; }));
        CHECK_FALSE(is_pulling(service));
        DeviceState state;
        CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh && !state.calibrated; }));
        service.send_event(safety_event("ebrake_released"));
        CHECK(pulls_until(*device, [&] { return is_pulling(service); }));
        CHECK(device->trouble() == std::string());
    }
    SUBCASE("a motor that stalled")
    {
        service.send_event(safety_event("stall_detected"));
        keeps_zero("the stall of a motor", Clock::now());
        CHECK(std::string(device->trouble()).find("stalled") != std::string::npos);
        CHECK(pulls_until(*device, [&] { return is_pulling(service); }));
    }
    SUBCASE("the ceiling of stability")
    {
        service.send_event(safety_event("stability_ceiling"));
        keeps_zero("the ceiling of stability", Clock::now());
    }
    SUBCASE("an event of another device changes nothing")
    {
        service.send_event(R"({"name":"device-safety-triggered","data":{"device_id":"OTHER",)"
                           R"("safety_type":"ebrake_triggered"}})");
        const size_t before = service.heard().size();
        CHECK(pulls_until(*device, [&] { return service.heard().size() > before + 30 && is_pulling(service); }));
        CHECK(device->trouble() == std::string());
    }
    SUBCASE("a channel of events that ends")
    {
        service.end_event_connections();
        keeps_zero("the end of the channel of events", Clock::now());
        CHECK(pulls_until(*device, [&] { return is_pulling(service); }));
        CHECK(device->counts().connections == 2);
    }
    SUBCASE("a connection that ends")
    {
        const Clock::time_point start = Clock::now();
        service.end_connections();
        const size_t before = service.heard().size();  // on the connection that has ended
        DeviceState state;
        CHECK(comes_true([&] { return device->read(state) == ReadResult::lost; }));
        MESSAGE("lost ", std::chrono::duration<double, std::milli>(Clock::now() - start).count(), " ms after the end");
        CHECK(comes_true([&] { return device->counts().connections == 2; }));
        MESSAGE("connected anew ", std::chrono::duration<double, std::milli>(Clock::now() - start).count(),
                " ms after the end");
        CHECK(comes_true([&] { return service.heard().size() > before; }));
        CHECK(service.heard()[before].force_n == glm::dvec3(0.0));
        CHECK(pulls_until(*device, [&] { return is_pulling(service); }));
    }
}

TEST_CASE("closing the device ends with a zero force")
{
    Inverse3Service service;
    pulling(service).reset();
    CHECK(comes_true([&] { return service.heard().back().force_n == glm::dvec3(0.0); }));
}

TEST_CASE("after a message that is not as documented there is no force, and one sentence says why")
{
    const std::string state = inverse3_state_text(glm::dvec3(0.0));
    std::string huge(300 << 10, ' ');
    struct Row {
        const char* what;
        std::string answer, raw;
        const char* said;
    };
    const std::vector<Row> rows{
        {"cut", state.substr(0, state.size() / 2), "", "it ends too early"},
        {"not finite", R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":1e999,"y":0,"z":0}}}]})", "",
         "a number that is not finite"},
        {"far away", inverse3_state_text({1e30, 0.0, 0.0}), "", "a place that no device reaches"},
        {"huge", "", frame_of(huge), "a message of more than 256 KiB"},
        {"an answer too many", "", frame_of(state) + frame_of(state) + frame_of(state), "an answer to no message"},
        {"out of order", "", std::string("\x80\x02{}", 4), "a part of a message without its beginning"},
        {"no JSON", "hello", "", "a value of another type than expected"},
    };
    for (const Row& row : rows) {
        CAPTURE(row.what);
        Inverse3Service service;
        Inverse3Options options = options_for(service);
        options.hold = milliseconds(150);
        const auto device = pulling(service, options);
        if (!row.raw.empty()) service.send_bytes(row.raw);
        if (!row.answer.empty()) service.set_answer([&](const glm::dvec3&) { return row.answer; });
        std::string said;
        CHECK(pulls_until(*device, [&] {
            if (said.empty()) said = device->trouble();
            return device->counts().refused > 0;
        }));
        const Clock::time_point refused = Clock::now();
        if (said.empty()) said = device->trouble();  // which is there before the count, and until the hold ends
        CHECK(said == std::string("the Inverse3's service sent what it must not: ") + row.said);
        DeviceState last;
        CHECK(comes_true([&] { return device->read(last) == ReadResult::lost; }));
        service.set_answer([](const glm::dvec3&) { return inverse3_state_text(glm::dvec3(0.0)); });
        CHECK(pulls_until(*device, [&] { return device->counts().connections >= 2 && is_pulling(service); }));
        CHECK(zero_after_ms(service.heard(), refused) < 0.0);  // it pulls again, after a zero
    }
}

TEST_CASE("without permission, and without the channel of events, there is no force")
{
    Inverse3Service service;
    Inverse3Options options = options_for(service);
    SUBCASE("permission")
    {
        options.allow_force = false;
    }
    SUBCASE("events")
    {
        options.event_port = 1;
    }
    const auto device = open_inverse3(options);
    REQUIRE(device);
    CHECK(device->caps().outputs_force == options.allow_force);
    CHECK((std::string(device->trouble()).find("port 10020") != std::string::npos) == options.allow_force);
    CHECK(pulls_until(*device, [&] { return service.heard().size() > 50; }));
    for (const Inverse3Heard& each : service.heard()) CHECK(each.force_n == glm::dvec3(0.0));
}

TEST_CASE("where no service listens there is no device; where something else does, that is said")
{
    CHECK(open_inverse3({.port = 1, .event_port = 1}) == nullptr);
    Inverse3Service service;
    const auto error_of = [&](Inverse3Options options) {
        options.connect_timeout = milliseconds(2000);
        try {
            open_inverse3(options);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    Inverse3Options options = options_for(service);
    options.device_id = "OTHER";
    CHECK(error_of(options).find("it does not list the device of that id; expected the Inverse service 3.5") !=
          std::string::npos);
    options.device_id.clear();
    service.set_inventory(R"({"session_id":7,"inverse3":[]})");
    CHECK(error_of(options).find("it lists no Inverse3") != std::string::npos);
    service.set_inventory("{");
    CHECK(error_of(options).find("it ends too early") != std::string::npos);
    options.port = service.event_port();
    options.connect_timeout = milliseconds(100);
    try {
        open_inverse3(options);
        CHECK(false);
    } catch (const Error& error) {
        CHECK(std::string(error.what()).find("it sends no list of devices") != std::string::npos);
    }
}
