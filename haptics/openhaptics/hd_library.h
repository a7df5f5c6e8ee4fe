#pragma once
// The library of 3D Systems' OpenHaptics (libHD.so), loaded at run time: SHVR neither ships the library or its header
// nor needs them to be built. Prototypes and values are written from the public documentation of OpenHaptics. Used on
// Linux, where OpenHaptics 3.4 exists.

#include <cstdint>
#include <string>

namespace shvr {

using HdHandle = uint32_t;
struct HdError {
    uint32_t code = 0;
    int32_t internal_code = 0;
    HdHandle device = 0;
};

namespace hd {

inline constexpr HdHandle INVALID_HANDLE = 0xffffffff;

inline constexpr uint32_t CURRENT_BUTTONS = 0x2000;
inline constexpr uint32_t CURRENT_POSITION = 0x2050;   ///< mm
inline constexpr uint32_t CURRENT_TRANSFORM = 0x2052;  ///< 4 x 4 matrix, stored by columns
inline constexpr uint32_t DEVICE_MODEL_TYPE = 0x2501;
inline constexpr uint32_t DEVICE_SERIAL_NUMBER = 0x2504;
inline constexpr uint32_t USABLE_WORKSPACE = 0x2551;       ///< mm: lower x, y, z, then upper x, y, z
inline constexpr uint32_t NOMINAL_MAX_STIFFNESS = 0x2602;  ///< 0 ... 1
inline constexpr uint32_t NOMINAL_MAX_FORCE = 0x2603;      ///< N
inline constexpr uint32_t NOMINAL_MAX_CONTINUOUS_FORCE = 0x2604;
inline constexpr uint32_t MOTOR_TEMPERATURE = 0x2605;  ///< one fraction per motor; at 1 a motor is too hot
inline constexpr uint32_t CURRENT_FORCE = 0x2700;      ///< N
inline constexpr uint32_t FORCE_OUTPUT = 0x4000;

inline constexpr uint32_t CALIBRATION_OK = 0x5000;
inline constexpr uint32_t CALIBRATION_NEEDS_UPDATE = 0x5001;
inline constexpr uint32_t CALIBRATION_BY_HAND = 0x5002;

inline constexpr uint32_t CALIBRATE_BY_ITSELF = 2;

inline constexpr uint32_t WARM_MOTORS = 0x0200;
inline constexpr uint32_t EXCEEDED_MAX_FORCE = 0x0201;
inline constexpr uint32_t EXCEEDED_MAX_VELOCITY = 0x0203;
inline constexpr uint32_t DEVICE_FAULT = 0x0300;
inline constexpr uint32_t COMM_ERROR = 0x0302;

inline constexpr uint32_t CALLBACK_DONE = 0, CALLBACK_CONTINUE = 1;
inline constexpr uint16_t PRIORITY = 0x7fff;  ///< the middle of its range

}  // namespace hd

/// The functions that SHVR calls.
struct HdLibrary {
    HdHandle (*init_device)(const char* name) = nullptr;
    void (*disable_device)(HdHandle) = nullptr;
    void (*make_current)(HdHandle) = nullptr;
    void (*begin_frame)(HdHandle) = nullptr;
    void (*end_frame)(HdHandle) = nullptr;
    HdError (*get_error)() = nullptr;
    const char* (*error_string)(uint32_t code) = nullptr;
    void (*enable)(uint32_t) = nullptr;
    void (*disable)(uint32_t) = nullptr;
    void (*get_doubles)(uint32_t, double*) = nullptr;
    void (*get_integers)(uint32_t, int32_t*) = nullptr;
    const char* (*get_string)(uint32_t) = nullptr;
    void (*set_doubles)(uint32_t, const double*) = nullptr;
    unsigned long (*schedule)(uint32_t (*callback)(void*), void* data, uint16_t priority) = nullptr;
    void (*unschedule)(unsigned long) = nullptr;
    void (*start_scheduler)() = nullptr;
    void (*stop_scheduler)() = nullptr;
    uint32_t (*check_calibration)() = nullptr;
    void (*update_calibration)(uint32_t style) = nullptr;
};

/// Returns null if the library is not installed. Fails if the library lacks a function. A loaded library stays loaded
/// until the program ends, since the driver does not survive being loaded twice.
const HdLibrary* load_hd_library(const std::string& name);

}  // namespace shvr
