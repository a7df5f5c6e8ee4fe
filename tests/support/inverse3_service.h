#pragma once
// A stand-in for the service of the Inverse3, written from its public documentation: an inventory, then one state for
// each message, and events on a second port. Ports of the own machine that the system chooses. Its thread does all; the
// calls here take a lock.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

struct Inverse3Heard {
    std::chrono::steady_clock::time_point at;
    glm::dvec3 force_n{0.0};  ///< in the service's frame
};

/// The state of a device at that place, in the service's frame.
std::string inverse3_state_text(const glm::dvec3& position_m, const std::string& device_id = "049D");

class Inverse3Service {
public:
    Inverse3Service();
    ~Inverse3Service();
    Inverse3Service(const Inverse3Service&) = delete;
    Inverse3Service& operator=(const Inverse3Service&) = delete;
    uint16_t port() const;
    uint16_t event_port() const;

    /// The inventory of connections to come; a state at the origin at first.
    void set_inventory(const std::string& text);
    /// Answers each message; the state at the origin at first. Called on the service's thread.
    void set_answer(const std::function<std::string(const glm::dvec3& force_n)>& answer);
    /// A service that stalls reads and does not answer; what it owes it sends when it goes on.
    void set_stalled(bool is_stalled);
    void send_event(const std::string& text);
    /// Bytes on the channel of states, as they are.
    void send_bytes(const std::string& bytes);
    void end_connections();
    void end_event_connections();
    bool has_clients() const;  ///< on both channels
    std::vector<Inverse3Heard> heard() const;
    std::string first_message() const;  ///< first message of the last connection

private:
    struct World;
    std::unique_ptr<World> world_;
};

}  // namespace shvr
