#include "haptics/inverse3/inverse3_link.h"

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/latest.h"
#include "haptics/inverse3/inverse3_message.h"
#include "haptics/inverse3/websocket_client.h"

namespace shvr {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Event = WebSocketReader::Event;

constexpr milliseconds RETRY_EVERY{20};
constexpr milliseconds GIVE_UP{1000};  ///< a connection without an answer for this long is closed
constexpr int LINK_PRIORITY = 81;      ///< above the servo's priority, since the thread runs briefly and then waits
constexpr double PEAK_FORCE_N = 3.3;   ///< a limit of this program, not of the maker: untested on the device
constexpr double CONTINUOUS_FORCE_N = 0.88;
constexpr double STIFFNESS_LIMIT = 250.0;  ///< N/m, for an arm of low friction and two ticks of delay

struct Reading {
    uint64_t connection = 0;
    DeviceState state;
};
struct Command {
    glm::dvec3 force_n{0.0};
    uint32_t sequence = 0;
    uint64_t interruptions = 0;  ///< number of interruptions that the servo knew of when it wrote this force
};

struct Channels {
    std::unique_ptr<WebSocketClient> states, events;
    std::string device_id;
    std::string trouble;  ///< why `states` is null
};

/// Reads the first message of the service, which lists its devices.
bool read_inventory(Channels& channels, const Inverse3Options& options)
{
    const SteadyClock::time_point until = SteadyClock::now() + options.connect_timeout;
    for (;;) {
        const Event event = channels.states->next();
        if (event == Event::none) {
            channels.trouble = "it sends no list of devices";
            if (!channels.states->wait(until) || !channels.states->receive()) return false;
            continue;
        }
        Inverse3State state;
        const char* wrong = event == Event::text
                                ? read_inverse3_state(channels.states->payload(), options.device_id, state)
                            : event == Event::refused ? channels.states->trouble()
                                                      : "it closes the connection";
        channels.device_id = state.device_id;
        channels.trouble = wrong                         ? wrong
                           : !channels.device_id.empty() ? ""
                           : options.device_id.empty()   ? "it lists no Inverse3"
                                                         : "it does not list the device of that id";
        return channels.trouble.empty();
    }
}

Channels connect(const Inverse3Options& options)
{
    Channels channels;
    channels.states = WebSocketClient::connect(options.port, options.connect_timeout, channels.trouble);
    if (!channels.states) return channels;
    if (!read_inventory(channels, options)) {
        channels.states = nullptr;
        return channels;
    }
    std::string ignored;
    channels.events = WebSocketClient::connect(options.event_port, options.connect_timeout, ignored);
    return channels;
}

/// Returns a copy of `text` that is never freed. Equal texts share one copy, so there are few: one per kind of failure.
const char* kept(const std::string& text)
{
    static std::mutex mutex;
    static std::set<std::string> all;
    const std::lock_guard lock(mutex);
    return all.insert(text).first->c_str();
}

class Link : public Inverse3 {
public:
    Link(const Inverse3Options& options, Channels channels)
        : options_(options),
          channels_(std::move(channels)),
          device_id_(channels_.device_id),
          wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC))
    {
        if (wake_ < 0) fail("the Inverse3's thread cannot be woken; expected fewer open files");
        options_.device_id = device_id_;  // after a lost connection, looks for the same device
        begin();
        thread_ = std::thread(&Link::run, this);
        ::pthread_setname_np(thread_.native_handle(), "inverse3");
        sched_param parameters{};
        parameters.sched_priority = LINK_PRIORITY;
        if (options_.realtime) ::pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &parameters);
    }
    ~Link() override
    {
        is_running_ = false;
        wake();
        thread_.join();
        ::close(wake_);
    }

    // ---- The servo's side ----

    DeviceCaps caps() const noexcept override
    {
        // The box is centred on the workspace in the service's default mount. The force limits are this program's own.
        const glm::dvec3 middle = from_inverse3({0.0, -0.12, 0.15});
        return {.usable_lower_m = middle - 0.08,
                .usable_upper_m = middle + 0.08,
                .peak_force_n = PEAK_FORCE_N,
                .continuous_force_n = CONTINUOUS_FORCE_N,
                .stiffness_limit = STIFFNESS_LIMIT,
                .latency_s = 0.002,
                .senses_rotation = true,
                .outputs_force = options_.allow_force,
                .tells_force_sequence = true};
    }
    ReadResult read(DeviceState& state) noexcept override
    {
        const uint64_t connection = connection_, interruptions = interruptions_;
        if (connection == 0) return ReadResult::lost;
        // An interruption set the force to zero. `lost` makes the servo fade the force in again instead of resuming it.
        if (std::exchange(interruptions_seen_, interruptions) != interruptions) return ReadResult::lost;
        if (!readings_.take() || readings_.value().connection != connection) return ReadResult::stale;
        state = readings_.value().state;
        return ReadResult::fresh;
    }
    bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept override
    {
        commands_.publish({force_n, sequence, interruptions_seen_});
        wake();
        return connection_ != 0;
    }
    const char* trouble() const noexcept override { return trouble_; }
    const std::string& device_id() const override { return device_id_; }
    Inverse3Counts counts() const noexcept override { return {sent_, answered_, refused_, connections_}; }

private:
    /// Wakes the link's thread by a write to a non-blocking eventfd.
    void wake() noexcept
    {
        const uint64_t one = 1;
        [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof one);
    }
    uint64_t stamp() const
    {
        if (options_.now_ns) return options_.now_ns();
        return uint64_t(SteadyClock::now().time_since_epoch() / std::chrono::nanoseconds(1));
    }

    // ---- The link's thread ----

    void run()
    {
        while (is_running_) {
            if (channels_.states) {
                serve();
            } else {
                sleep_until(std::max(SteadyClock::now() + RETRY_EVERY, next_try_));
                if (!is_running_) break;
                const SteadyClock::time_point begun = SteadyClock::now();
                channels_ = connect(options_);
                if (!channels_.states)
                    next_try_ = SteadyClock::now() + (SteadyClock::now() - begun);  // retries use half a core at most
                if (channels_.states)
                    begin();
                else
                    trouble_ = channels_.trouble.empty()
                                   ? "the Inverse3's service is gone"
                                   : kept("the Inverse3's service is of no use: " + channels_.trouble);
            }
        }
        if (channels_.states) {
            send({}, commands_.value().sequence + 1);
            channels_.states->close();
        }
    }

    void sleep_until(SteadyClock::time_point until)
    {
        while (is_running_ && SteadyClock::now() < until) std::this_thread::sleep_for(milliseconds(5));
    }

    void begin()
    {
        in_flight_ = 0;
        is_first_ = true;
        is_braked_ = is_unplugged_ = is_telling_ = false;  // a device that brakes locks itself
        ++interruptions_;                                  // reject forces written for the previous connection
        last_sent_force_ = glm::dvec3(0.0);
        sent_at_ = write_at_ = SteadyClock::now();
        events_tried_ = SteadyClock::now();
        trouble_ = channels_.events ? "" : NO_EVENTS;
        connection_ = ++connections_;
    }
    /// Connects to the event channel. May block: no force is in effect without that channel, so no state is urgent.
    void find_events()
    {
        std::string ignored;
        channels_.events = WebSocketClient::connect(options_.event_port, options_.connect_timeout, ignored);
        events_tried_ = SteadyClock::now();
        if (channels_.events) trouble_ = "";
    }

    /// Runs one iteration of the thread's loop: waits, receives, and sends the messages that are due.
    void serve()
    {
        std::array<pollfd, 3> each{pollfd{wake_, POLLIN, 0}, pollfd{channels_.states->descriptor(), POLLIN, 0},
                                   pollfd{channels_.events ? channels_.events->descriptor() : -1, POLLIN, 0}};
        const timespec most{0, 2'000'000};  // the deadlines below are multiples of milliseconds
        ::ppoll(each.data(), each.size(), &most, nullptr);
        if (each[0].revents) take_command();
        if (each[2].revents && !take_events()) return lose();
        if (each[1].revents && !take_states()) return lose();
        if (is_telling_ && !is_held()) {
            is_telling_ = false;
            trouble_ = channels_.events ? "" : NO_EVENTS;
        }
        if (!channels_.events && options_.allow_force && SteadyClock::now() - events_tried_ > options_.hold)
            find_events();
        send_what_is_due();
    }

    void take_command()
    {
        uint64_t count = 0;
        [[maybe_unused]] const ssize_t size = ::read(wake_, &count, sizeof count);
        if (!commands_.take()) return;
        has_command_ = true;
        write_at_ = SteadyClock::now();
    }

    bool take_states()
    {
        const bool is_open = channels_.states->receive();
        for (Event event = channels_.states->next(); event != Event::none; event = channels_.states->next()) {
            if (event == Event::close) return false;
            Inverse3State state;
            const char* wrong = event == Event::refused ? channels_.states->trouble()
                                : in_flight_ == 0       ? "an answer to no message"
                                                  : read_inverse3_state(channels_.states->payload(), device_id_, state);
            if (wrong) return refuse(wrong);
            if (state.device_id.empty()) return false;
            --in_flight_;
            ++answered_;
            publish(state);
        }
        return is_open;
    }

    void publish(const Inverse3State& from)
    {
        Reading& reading = readings_.writing();
        reading = {connection_, {}};
        DeviceState& state = reading.state;
        state.time_ns = stamp();
        state.sequence = uint32_t(answered_);
        state.force_sequence = last_sent_sequence_;
        state.position_m = from_inverse3(from.position_m);
        state.rotation = from.rotation;
        state.buttons = from.buttons;
        state.calibrated = !is_held() && channels_.events != nullptr;
        readings_.publish();
    }

    /// Returns false if the channel has ended.
    bool take_events()
    {
        const bool is_open = channels_.events->receive();
        for (Event event = channels_.events->next(); event != Event::none; event = channels_.events->next()) {
            Inverse3Notice notice;
            const bool is_read = event == Event::text && !read_inverse3_notice(channels_.events->payload(), notice);
            if (!is_read) return false;
            if (notice.device_id.empty() || notice.device_id == device_id_) heed(notice.event);
        }
        return is_open;
    }

    void heed(Inverse3Event event)
    {
        using enum Inverse3Event;
        is_telling_ = is_telling_ || event != other;
        switch (event) {
            case ebrake_on:
                is_braked_ = true;
                trouble_ = "the Inverse3's emergency brake is on: no force until it is released";
                break;
            case ebrake_off:
                is_braked_ = false;
                hold();
                break;
            case stall:
                trouble_ = "a motor of the Inverse3 stalled: the force fades in anew";
                hold();
                break;
            case ceiling:
                trouble_ = "the Inverse3 reached the limit of its stability: the force fades in anew";
                hold();
                break;
            case disconnected:
                trouble_ = "the Inverse3 was unplugged from its service";
                is_unplugged_ = true;
                break;
            case connected: is_unplugged_ = false; break;
            case other: break;
        }
    }
    void hold() { held_until_ = SteadyClock::now() + options_.hold; }
    bool is_held() const { return is_braked_ || is_unplugged_ || SteadyClock::now() < held_until_; }

    void send_what_is_due()
    {
        const SteadyClock::time_point now = SteadyClock::now();
        const bool is_unanswered = in_flight_ > 0 && now - sent_at_ > options_.answer_timeout;
        const bool is_unwritten = now - write_at_ > options_.write_timeout;
        if (in_flight_ > 0 && now - sent_at_ > std::max(GIVE_UP, options_.answer_timeout)) {
            trouble_ = "the Inverse3's service does not answer";
            return lose();
        }
        const glm::dvec3 wanted = commands_.value().force_n;
        const bool may_force = options_.allow_force && channels_.events && !is_held() && !is_unanswered &&
                               !is_unwritten && commands_.value().interruptions == interruptions_ &&
                               std::isfinite(glm::length(wanted));
        const bool is_pulling = last_sent_force_ != glm::dvec3(0.0);
        if (is_pulling && !may_force) {  // a zero force is sent at once, even while a message is unanswered
            ++interruptions_;
            if (!send({}, commands_.value().sequence)) lose();
            return;
        }
        if (in_flight_ > 0 || (!has_command_ && now - sent_at_ < options_.keep_alive)) return;
        const double length = glm::length(wanted);
        const glm::dvec3 force = !may_force              ? glm::dvec3(0.0)
                                 : length > PEAK_FORCE_N ? wanted * (PEAK_FORCE_N / length)
                                                         : wanted;
        if (!send(force, commands_.value().sequence)) lose();
    }

    bool send(const glm::dvec3& force_n, uint32_t sequence)
    {
        text_.clear();
        // + 0.0 turns -0 into 0; a zero force would otherwise be printed as "-0" after its axes are rotated
        append_inverse3_command(text_, device_id_, to_inverse3(force_n) + 0.0, std::exchange(is_first_, false));
        if (!channels_.states->send_text(text_)) return false;
        has_command_ = false;
        last_sent_force_ = force_n;
        last_sent_sequence_ = sequence;
        if (in_flight_++ == 0) sent_at_ = SteadyClock::now();
        ++sent_;
        return true;
    }

    bool refuse(const char* wrong)
    {
        trouble_ = kept(sentence("the Inverse3's service sent what it must not: ", wrong));
        ++refused_;  // incremented last, so that a reader of the new count also sees the reason
        next_try_ = SteadyClock::now() + options_.hold;
        return false;
    }
    void lose()
    {
        connection_ = 0;
        send({}, commands_.value().sequence);  // in case the service still receives
        channels_.states->close();
        channels_ = {};
    }

    static constexpr const char* NO_EVENTS =
        "the Inverse3's channel of safety events (port 10020) is not there: no force without it";

    Inverse3Options options_;
    Channels channels_;
    const std::string device_id_;
    const int wake_;

    std::atomic<bool> is_running_{true};
    std::atomic<uint64_t> connection_{0};  ///< 0: none
    std::atomic<uint64_t> connections_{0}, sent_{0}, answered_{0}, refused_{0};
    std::atomic<uint64_t> interruptions_{0};  ///< how often zero replaced the servo's force
    uint64_t interruptions_seen_ = 0;         ///< used by the servo only
    std::atomic<const char*> trouble_{""};

    // Used by the link's thread only.
    int in_flight_ = 0;
    bool is_first_ = true, has_command_ = false, is_braked_ = false, is_unplugged_ = false;
    bool is_telling_ = false;  ///< `trouble_` describes an event; cleared when that event's hold time ends
    glm::dvec3 last_sent_force_{0.0};
    uint32_t last_sent_sequence_ = 0;
    SteadyClock::time_point sent_at_, write_at_, held_until_, next_try_, events_tried_;
    std::string text_;

    Latest<Reading> readings_;
    Latest<Command> commands_;
    std::thread thread_;
};

}  // namespace

std::unique_ptr<Inverse3> open_inverse3(const Inverse3Options& options)
{
    Channels channels = connect(options);
    if (channels.states) return std::make_unique<Link>(options, std::move(channels));
    if (channels.trouble.empty()) return nullptr;
    fail("port ", options.port, " of this machine: ", channels.trouble,
         "; expected the Inverse service 3.5 or newer, with a device that is plugged in");
}

Inverse3Found find_inverse3(const Inverse3Options& options)
{
    Channels channels;
    channels.states = WebSocketClient::connect(options.port, options.connect_timeout, channels.trouble);
    if (channels.states) {
        read_inventory(channels, options);
        channels.states->close();
    }
    return {channels.states || !channels.trouble.empty(), channels.device_id, channels.trouble};
}

}  // namespace shvr
