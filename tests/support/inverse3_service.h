#pragma once
// A stand-in for the service of the Inverse3, written from its public documentation: an inventory, then one state for
// each message, and events on a second port. It listens on local ports that the system chooses. Its thread does all the
// work; the calls here take a lock.

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

/// The state message of a device at that position, in the service's frame.
std::string inverse3_state_text(const glm::dvec3& position_m, const std::string& device_id = "049D");

class Inverse3Service {
public:
    Inverse3Service();
    ~Inverse3Service();
    Inverse3Service(const Inverse3Service&) = delete;
    Inverse3Service& operator=(const Inverse3Service&) = delete;
    uint16_t port() const;
    uint16_t event_port() const;

    /// Sets the inventory that later connections receive; by default it has a device at the origin.
    void set_inventory(const std::string& text);
    /// Sets the answer to each message; by default the state at the origin. Called on the service's thread.
    void set_answer(const std::function<std::string(const glm::dvec3& force_n)>& answer);
    /// Stalls the service: it reads but does not answer. It sends the pending answers when it resumes.
    void set_stalled(bool is_stalled);
    void send_event(const std::string& text);
    /// Sends raw bytes on the channel of states.
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
