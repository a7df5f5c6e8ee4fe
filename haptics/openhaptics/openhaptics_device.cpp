#include "haptics/openhaptics/openhaptics_device.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/latest.h"
#include "haptics/openhaptics/hd_library.h"

namespace shvr {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds WRITE_TIMEOUT{18};
constexpr std::chrono::milliseconds HOLD{100};   ///< time without force after an error; the servo notices within it
constexpr double TOO_WARM = 0.95;                ///< fraction of the motors' limit at which force ends, before the
                                                 ///< driver switches off by itself
constexpr double WARM_AGAIN = 0.8;               ///< below it force is enabled again
constexpr uint64_t MAX_ERRORS = 100;             ///< consecutive errors (0.1 s) after which the device is gone
constexpr double RECOMMENDED_STIFFNESS = 400.0;  ///< N/m, chai3d's figure for a Touch; two ticks of delay

std::atomic<bool> is_in_use{false};

/// Releases the device, however opening ends.
struct Claim {
    Claim()
    {
        if (is_in_use.exchange(true)) fail("OpenHaptics: is in use by this program; expected one device at a time");
    }
    ~Claim() { is_in_use = false; }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
};

/// Returns a user-readable message for a driver error.
std::string in_words(const HdLibrary& hd, const HdError& error)
{
    switch (error.code) {
        case hd::WARM_MOTORS: return "its motors are too warm; expected a rest of some minutes";
        case hd::COMM_ERROR:
            return sentence("it does not answer (communication error, internal ", error.internal_code,
                            "); expected its cable and power, and the driver's udev rule");
        case hd::DEVICE_FAULT: return "it reports a fault; expected its status light to be steady";
        default: break;
    }
    const char* const text = hd.error_string(error.code);
    return sentence("its driver says \"", text ? text : "", "\" (", error.code, ")");
}

class Device : public OpenHaptics {
public:
    Device(const HdLibrary& library, const OpenHapticsOptions& options) : hd_(library)
    {
        handle_ = hd_.init_device(options.device.empty() ? nullptr : options.device.c_str());
        if (const HdError error = hd_.get_error(); error.code != 0 || handle_ == hd::INVALID_HANDLE) {
            if (handle_ != hd::INVALID_HANDLE) hd_.disable_device(handle_);
            fail(options.library, ": no device: ",
                 error.code ? in_words(hd_, error)
                            : std::string("none was found; expected one that is set up with the maker's tool"));
        }
        try {
            begin(options);
        } catch (...) {
            hd_.disable_device(handle_);
            throw;
        }
    }
    ~Device() override
    {
        is_ending_ = true;  // the next call sets zero
        const SteadyClock::time_point most = SteadyClock::now() + WRITE_TIMEOUT;
        while (!has_ended_ && SteadyClock::now() < most) {
        }
        hd_.unschedule(callback_);
        hd_.stop_scheduler();
        hd_.make_current(handle_);
        hd_.disable(hd::FORCE_OUTPUT);
        hd_.disable_device(handle_);
    }

    // ---- The servo's side ----

    DeviceCaps caps() const noexcept override { return caps_; }
    ReadResult read(DeviceState& state) noexcept override
    {
        if (is_lost_) return ReadResult::lost;
        if (!states_.take()) return ReadResult::stale;
        state = states_.value();
        return ReadResult::fresh;
    }
    bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept override
    {
        commands_.publish({force_n, sequence});
        return !is_lost_;
    }
    const char* trouble() const noexcept override { return trouble_; }
    std::string model() const override { return model_; }
    std::string serial() const override { return serial_; }
    double motor_temperature() const noexcept override { return temperature_; }

private:
    struct Command {
        glm::dvec3 force_n{0.0};
        uint32_t sequence = 0;
    };

    void begin(const OpenHapticsOptions& options)
    {
        hd_.make_current(handle_);
        const auto text = [&](uint32_t what) {
            const char* const value = hd_.get_string(what);
            return std::string(value ? value : "");
        };
        model_ = text(hd::DEVICE_MODEL_TYPE);
        serial_ = text(hd::DEVICE_SERIAL_NUMBER);
        calibrate(options);
        read_caps(options.allow_force);
        if (options.allow_force) hd_.enable(hd::FORCE_OUTPUT);
        hd_.start_scheduler();
        if (const HdError error = hd_.get_error(); error.code != 0)
            fail(options.library, ": ", model_, ": ", in_words(hd_, error));
        callback_ = hd_.schedule(&Device::call, this, hd::PRIORITY);
    }

    void calibrate(const OpenHapticsOptions& options)
    {
        uint32_t state = hd_.check_calibration();
        if (state == hd::CALIBRATION_NEEDS_UPDATE && options.may_calibrate) {
            hd_.update_calibration(hd::CALIBRATE_BY_ITSELF);
            state = hd_.check_calibration();
        }
        if (state != hd::CALIBRATION_OK)
            fail(options.library, ": ", model_,
                 ": is not calibrated; expected the stylus in its inkwell, or the maker's calibration tool");
    }

    void read_caps(bool allow_force)
    {
        std::array<double, 6> box{};
        hd_.get_doubles(hd::USABLE_WORKSPACE, box.data());
        const glm::dvec3 lower(box[0], box[1], box[2]), upper(box[3], box[4], box[5]);
        if (is_finite(lower) && is_finite(upper) && glm::all(glm::lessThan(lower, upper))) {
            caps_.usable_lower_m = lower * 1e-3;
            caps_.usable_upper_m = upper * 1e-3;
        }
        const auto lessened = [&](uint32_t what, double& value) {
            double stated = 0.0;
            hd_.get_doubles(what, &stated);
            if (stated > 0.0) value = std::min(value, stated);
        };
        lessened(hd::NOMINAL_MAX_FORCE, caps_.peak_force_n);
        lessened(hd::NOMINAL_MAX_CONTINUOUS_FORCE, caps_.continuous_force_n);
        caps_.stiffness_limit = RECOMMENDED_STIFFNESS;
        caps_.senses_rotation = true;
        caps_.outputs_force = allow_force;
        caps_.tells_force_sequence = true;
        hd_.get_error();  // discard the error: the device may not report every value
    }

    // ---- The driver's thread ----

    static uint32_t call(void* self) noexcept { return static_cast<Device*>(self)->tick(); }

    uint32_t tick() noexcept
    {
        if (is_lost_ || has_ended_) return hd::CALLBACK_DONE;
        hd_.begin_frame(handle_);
        publish_state();
        const glm::dvec3 force = force_now();
        const std::array<double, 3> newtons{force.x, force.y, force.z};
        hd_.set_doubles(hd::CURRENT_FORCE, newtons.data());
        hd_.end_frame(handle_);
        heed_errors();
        if (is_ending_) has_ended_ = true;
        return is_lost_ || has_ended_ ? hd::CALLBACK_DONE : hd::CALLBACK_CONTINUE;
    }

    void publish_state() noexcept
    {
        std::array<double, 3> place{}, motors{};
        std::array<double, 16> matrix{};
        int32_t buttons = 0;
        hd_.get_doubles(hd::CURRENT_POSITION, place.data());
        hd_.get_doubles(hd::CURRENT_TRANSFORM, matrix.data());
        hd_.get_doubles(hd::MOTOR_TEMPERATURE, motors.data());
        hd_.get_integers(hd::CURRENT_BUTTONS, &buttons);
        temperature_ = std::max({motors[0], motors[1], motors[2]});

        DeviceState& state = states_.writing();
        state = {};
        state.time_ns = uint64_t(SteadyClock::now().time_since_epoch() / std::chrono::nanoseconds(1));
        state.sequence = ++sequence_;
        state.force_sequence = set_sequence_;
        state.position_m = glm::dvec3(place[0], place[1], place[2]) * 1e-3;
        const glm::dmat3 turned(glm::dvec3(matrix[0], matrix[1], matrix[2]),
                                glm::dvec3(matrix[4], matrix[5], matrix[6]),
                                glm::dvec3(matrix[8], matrix[9], matrix[10]));
        if (std::abs(glm::determinant(turned) - 1.0) < 0.1) state.rotation = glm::normalize(glm::quat_cast(turned));
        state.buttons = uint32_t(buttons) & (PAINT_BUTTON | MOVE_BUTTON);
        state.calibrated = !is_warm_ && !has_error_;
        states_.publish();
    }

    glm::dvec3 force_now() noexcept
    {
        const SteadyClock::time_point now = SteadyClock::now();
        if (commands_.take()) written_ = now;
        is_warm_ = temperature_ > (is_warm_ ? WARM_AGAIN : TOO_WARM);
        const Command& command = commands_.value();
        set_sequence_ = command.sequence;
        const bool may_force =
            caps_.outputs_force && !is_ending_ && !is_warm_ && !has_error_ && now - written_ <= WRITE_TIMEOUT;
        const double length = glm::length(command.force_n);
        if (!may_force || !std::isfinite(length)) return glm::dvec3(0.0);
        return length > caps_.peak_force_n ? command.force_n * (caps_.peak_force_n / length) : command.force_n;
    }

    void heed_errors() noexcept
    {
        has_error_ = SteadyClock::now() < held_until_;
        bool is_new = false;
        const char* said = is_warm_ ? "the motors of the Touch are too warm: no force until they have cooled" : "";
        for (int i = 0; i < 8; ++i) {
            const HdError error = hd_.get_error();
            if (error.code == 0) break;
            has_error_ = is_new = true;
            held_until_ = SteadyClock::now() + HOLD;
            is_warm_ = is_warm_ || error.code == hd::WARM_MOTORS;
            if (error.code == hd::WARM_MOTORS)
                said = "the motors of the Touch are too warm: no force until they have cooled";
            else if (error.code >= hd::EXCEEDED_MAX_FORCE && error.code <= hd::EXCEEDED_MAX_VELOCITY)
                said = "the Touch was moved or driven beyond its limits: the force fades in anew";
            else
                said = error.code == hd::COMM_ERROR
                           ? "the Touch does not answer: its cable, its power, or its driver's udev rule"
                           : "the Touch reports a fault: its status light tells which";
            is_lost_ = is_lost_ || error.code == hd::COMM_ERROR || error.code == hd::DEVICE_FAULT;
        }
        errors_ = is_new ? errors_ + 1 : 0;
        if (errors_ >= MAX_ERRORS && !is_warm_) is_lost_ = true;
        if (is_new || !has_error_) trouble_ = said;
    }

    const Claim claim_;
    const HdLibrary& hd_;
    HdHandle handle_ = hd::INVALID_HANDLE;
    unsigned long callback_ = 0;
    std::string model_, serial_;
    DeviceCaps caps_;

    std::atomic<bool> is_lost_{false}, is_ending_{false}, has_ended_{false};
    std::atomic<double> temperature_{0.0};
    std::atomic<const char*> trouble_{""};

    // Used by the driver's thread only.
    bool is_warm_ = false, has_error_ = false;
    uint32_t sequence_ = 0, set_sequence_ = 0;
    uint64_t errors_ = 0;
    SteadyClock::time_point written_, held_until_;

    Latest<DeviceState> states_;
    Latest<Command> commands_;
};

}  // namespace

std::unique_ptr<OpenHaptics> open_openhaptics(const OpenHapticsOptions& options)
{
    const HdLibrary* const library = load_hd_library(options.library);
    if (!library) return nullptr;
    return std::make_unique<Device>(*library, options);
}

}  // namespace shvr
