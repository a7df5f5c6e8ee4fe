#pragma once
// Properties that the force law must have in many random cases, through the servo's own step(), as doctest assertions.

#include <cstdint>

namespace shvr {

/// One throw at a wall, or a push into it: what the hand gained and whether it still swings at the end.
struct Contact {
    double gained_j = 0.0;   ///< beyond what the law's potential gives at the place where it ends
    bool is_inside = false;  ///< it ends in contact
    double swing_m = 0.0;
    double force_swing_n = 0.0;
};
struct ContactCase {
    double stiffness = 300.0, damping = 1.0;
    bool has_friction = true;  ///< the friction of a Touch
    bool is_held = true;       ///< by a hand that pushes on; otherwise thrown, 0.1 to 0.3 m/s
    int delay_ticks = 2;
    double jitter_s = 0.0005, speed = 0.3, count_m = 55e-6;
    uint32_t seed = 1;
    bool clicks = false;
    bool is_tube = false;    ///< a tube that draws the probe in, instead of a surface that holds it
    bool is_broken = false;  ///< the device claims no latency and any stiffness, which the limits must catch
};
Contact contact(const ContactCase& one);

void check_contacts(int count, uint32_t seed);
void check_nonsense(int ticks, uint32_t seed);
void check_loops(int count, uint32_t seed);

}  // namespace shvr
