#include "haptics/hid/hid_protocol.h"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

HidProfile reference()
{
    return load_hid_profile("assets/devices/shvr_reference.json");
}

/// Report 1 of the documented layout, made by hand: little endian after the id.
std::vector<uint8_t> example_report()
{
    return {
        0x01,                    // id
        0x05, 0x01,              // buttons 1 and 3; calibrated
        0x34, 0x12,              // sequence 0x1234
        0x78, 0x56, 0x34, 0x12,  // 0x12345678 us
        0x40, 0x42, 0x0f, 0x00,  // x: 1,000,000 um
        0xff, 0xff, 0xff, 0xff,  // y: -1 um
        0x00, 0x00, 0x00, 0x80,  // z: -2^31 um
        0x00, 0x40,              // w: 0.5
        0x00, 0xc0,              // x: -0.5
        0x00, 0x40,              // y: 0.5
        0x00, 0x40,              // z: 0.5
        0xcd, 0xab,              // force 0xabcd is in effect
        0x2c, 0x01,              // motors
    };
}

std::vector<uint8_t> bytes_of(const HidBytes& report)
{
    return {report.span().begin(), report.span().end()};
}

}  // namespace

TEST_CASE("the reference's input report is decoded byte by byte")
{
    const std::vector<uint8_t> report = example_report();
    REQUIRE(report.size() == 33);
    const std::optional<HidInput> input = decode(reference(), report);
    REQUIRE(input);
    CHECK(input->buttons == 5);
    CHECK(input->calibrated == true);
    CHECK(input->sequence == 0x1234);
    CHECK(input->time == 0x12345678);
    CHECK(input->position_m->x == doctest::Approx(1.0));
    CHECK(input->position_m->y == doctest::Approx(-1e-6));
    CHECK(input->position_m->z == doctest::Approx(-2147.483648));
    CHECK(input->rotation->w == doctest::Approx(0.5));
    CHECK(input->rotation->x == doctest::Approx(-0.5));
    CHECK(input->rotation->y == doctest::Approx(0.5));
    CHECK(input->rotation->z == doctest::Approx(0.5));
    CHECK(input->force_sequence == 0xabcd);
}

TEST_CASE("a report of another length or with another id is refused, whatever it holds")
{
    const HidProfile profile = reference();
    std::vector<uint8_t> report = example_report();
    for (size_t length = 0; length < 100; ++length) {
        std::vector<uint8_t> other = report;
        other.resize(length, 0xff);
        CHECK(decode(profile, other).has_value() == (length == 33));
    }
    report[0] = 2;
    CHECK_FALSE(decode(profile, report));
}

TEST_CASE("10,000 random reports decode to finite places and unit rotations")
{
    std::mt19937 random(31);
    const HidProfile profile = reference();
    std::vector<uint8_t> report(33);
    for (int i = 0; i < 10'000; ++i) {
        for (uint8_t& byte : report) byte = uint8_t(random());
        report[0] = 1;
        const std::optional<HidInput> input = decode(profile, report);
        REQUIRE(input);
        REQUIRE(glm::length(*input->position_m) < 4000.0);
        REQUIRE(glm::dot(*input->rotation, *input->rotation) == doctest::Approx(1.0));
    }
}

TEST_CASE("a rotation of zeros is none")
{
    std::vector<uint8_t> report = example_report();
    std::fill(report.begin() + 21, report.begin() + 29, uint8_t(0));
    const std::optional<HidInput> input = decode(reference(), report);
    REQUIRE(input);
    CHECK(input->rotation == glm::dquat(1.0, 0.0, 0.0, 0.0));
}

TEST_CASE("the reference's output report is encoded byte by byte")
{
    const HidBytes report = encode(reference(), {0.258, -0.001, 1.5}, 0x1abcd, true);
    CHECK(bytes_of(report) ==
          std::vector<uint8_t>{0x02, 0x01, 20, 0xcd, 0xab, 0x02, 0x01, 0xff, 0xff, 0xdc, 0x05, 0, 0, 0, 0, 0, 0});
}

TEST_CASE("a force that is not enabled, or no number, is written as zero with the flag off")
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const std::vector<uint8_t> off{0x02, 0x00, 20, 7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    CHECK(bytes_of(encode(reference(), {1, 1, 1}, 7, false)) == off);
    for (const glm::dvec3& force :
         {glm::dvec3(nan, 0, 0), glm::dvec3(0, infinity, 0), glm::dvec3(0, 0, -infinity), glm::dvec3(1e300)})
        CHECK(bytes_of(encode(reference(), force, 7, true)) == off);
}

TEST_CASE("a force beyond the peak is shortened and keeps its direction")
{
    const HidBytes report = encode(reference(), {300.0, 400.0, 0.0}, 0, true);
    const auto millinewtons = [&](size_t byte) { return int16_t(report.bytes[byte] | report.bytes[byte + 1] << 8); };
    CHECK(millinewtons(5) == 1980);
    CHECK(millinewtons(7) == 2640);
    CHECK(millinewtons(9) == 0);
}

TEST_CASE("what is encoded and sent back is what was meant, for fields at odd bits")
{
    HidProfile profile;
    profile.limits.peak_force_n = 100.0;
    profile.output = HidReport{
        .id = 0,
        .length = 9,
        .fields = {{.quantity = HidQuantity::enable, .bit = 3, .bits = 1},
                   {.quantity = HidQuantity::force_x, .bit = 5, .bits = 13, .is_signed = true, .scale = 0.01},
                   {.quantity = HidQuantity::force_y, .bit = 18, .bits = 32, .is_signed = true, .scale = -1e-6},
                   {.quantity = HidQuantity::force_z, .bit = 51, .bits = 12, .scale = 0.01, .offset = -20.0}}};
    HidReport as_input = profile.output.value();
    as_input.fields[1].quantity = HidQuantity::position_x;
    as_input.fields[2].quantity = HidQuantity::position_y;
    as_input.fields[3].quantity = HidQuantity::position_z;
    HidProfile mirror = profile;
    mirror.inputs = {as_input};
    for (const glm::dvec3& force : {glm::dvec3(0.0), glm::dvec3(1.25, -3.5, 7.0), glm::dvec3(-40.0, 19.0, -19.99)}) {
        const HidBytes report = encode(profile, force, 0, true);
        CHECK(report.bytes[0] == 0);
        CHECK(report.size == 10);
        const std::optional<HidInput> input = decode(mirror, report.span().subspan(1));  // read without a number
        REQUIRE(input);
        CHECK(glm::distance(*input->position_m, force) < 1e-9);
    }
}

TEST_CASE("the axis map turns places in and forces out, so that work stays work")
{
    HidProfile profile = reference();
    // x right, y towards the user, z down, as on a SpaceMouse.
    profile.axes = glm::transpose(glm::dmat3(1, 0, 0, 0, 0, -1, 0, 1, 0));
    std::vector<uint8_t> report = example_report();
    const std::optional<HidInput> input = decode(profile, report);
    REQUIRE(input);
    CHECK(input->position_m->x == doctest::Approx(1.0));
    CHECK(input->position_m->y == doctest::Approx(2147.483648));
    CHECK(input->position_m->z == doctest::Approx(-1e-6));
    CHECK(input->rotation->x == doctest::Approx(-0.5));
    CHECK(input->rotation->y == doctest::Approx(-0.5));
    CHECK(input->rotation->z == doctest::Approx(0.5));
    // Up is the device's -z.
    const HidBytes up = encode(profile, {0.0, 1.0, 0.0}, 0, true);
    CHECK(int16_t(up.bytes[9] | up.bytes[10] << 8) == -1000);
    CHECK(int16_t(up.bytes[7] | up.bytes[8] << 8) == 0);
}

TEST_CASE("the feature report narrows the limits and never widens them")
{
    const HidProfile profile = reference();
    // 2 N, 100 x 120 x 400 mm, 55 um, firmware 1, 3 ms
    const std::vector<uint8_t> report{3, 0xd0, 0x07, 100, 0, 120, 0, 0x90, 0x01, 0x7c, 0x15, 1, 0, 0xb8, 0x0b, 0, 0};
    const DeviceCaps caps = decode_feature(profile, report);
    CHECK(caps.peak_force_n == doctest::Approx(2.0));
    CHECK(caps.continuous_force_n == doctest::Approx(0.88));
    CHECK(caps.usable_lower_m.x == doctest::Approx(-0.05));
    CHECK(caps.usable_upper_m.x == doctest::Approx(0.05));
    CHECK(caps.usable_upper_m.y == doctest::Approx(0.06));
    CHECK(caps.usable_upper_m.z == doctest::Approx(0.035));
    CHECK(caps.latency_s == doctest::Approx(0.003));
    std::vector<uint8_t> strong = report;
    strong[2] = 0xff;
    CHECK(decode_feature(profile, strong).peak_force_n == doctest::Approx(3.3));
    CHECK(decode_feature(profile, std::vector<uint8_t>{3, 0, 0}).peak_force_n == doctest::Approx(3.3));
}

TEST_CASE("a counter of 16 bits goes on over its overflow, over gaps, and a little back")
{
    Unwrapped counter(16);
    CHECK(counter.next(65'534) == 65'534);
    CHECK(counter.next(65'535) == 65'535);
    CHECK(counter.next(0) == 65'536);
    CHECK(counter.next(100) == 65'636);
    CHECK(counter.next(99) == 65'635);
    CHECK(counter.next(30'000) == 95'536);
    CHECK(counter.next(60'000) == 125'536);
    CHECK(counter.next(10) == 131'082);
    Unwrapped young(16);
    CHECK(young.next(5) == 5);
    CHECK(young.next(65'000) == 65'000);  // there is nothing before 0
    Unwrapped wide(32);
    CHECK(wide.next(0xffffffffu) == 0xffffffffu);
    CHECK(wide.next(1) == 0x100000001u);
}

TEST_CASE("a SpaceMouse's reports: translation, rotation, both in one, buttons, battery")
{
    const HidProfile mouse = load_hid_profile("assets/devices/spacemouse.json");
    // 350 to the right, -350 towards the user, 175 down.
    const std::vector<uint8_t> moved{1, 0x5e, 0x01, 0xa2, 0xfe, 0xaf, 0x00};
    std::optional<HidInput> input = decode(mouse, moved);
    REQUIRE(input);
    CHECK(glm::distance(*input->rate, glm::dvec3(1.0, -0.5, -1.0)) < 1e-12);
    CHECK_FALSE(input->turn_rate);
    CHECK_FALSE(input->position_m);
    CHECK_FALSE(input->buttons);
    std::vector<uint8_t> both = moved;
    both.insert(both.end(), {0x00, 0x00, 0x5e, 0x01, 0x00, 0x00});
    input = decode(mouse, both);
    REQUIRE(input);
    CHECK(glm::distance(*input->rate, glm::dvec3(1.0, -0.5, -1.0)) < 1e-12);
    CHECK(glm::distance(*input->turn_rate, glm::dvec3(0.0, 0.0, 1.0)) < 1e-12);
    input = decode(mouse, std::vector<uint8_t>{2, 0x00, 0x00, 0x00, 0x00, 0xa2, 0xfe});
    REQUIRE(input);
    CHECK(glm::distance(*input->turn_rate, glm::dvec3(0.0, 1.0, 0.0)) < 1e-12);
    input = decode(mouse, std::vector<uint8_t>{3, 0x02, 0x00});
    REQUIRE(input);
    CHECK(input->buttons == 2);
    CHECK_FALSE(decode(mouse, std::vector<uint8_t>{23, 80}));
    CHECK(is_ignored(mouse, std::vector<uint8_t>{23, 80}));
    CHECK_FALSE(is_ignored(mouse, std::vector<uint8_t>{9, 80}));
    CHECK_FALSE(is_ignored(mouse, {}));
}

TEST_CASE("a deflection becomes a speed: a dead zone, then a power, along the deflection")
{
    const HidRate rate{.gamma = 2.0, .dead_zone = 0.2};
    CHECK(shaped(rate, {0.1, 0.1, 0.1}) == glm::dvec3(0.0));
    CHECK(shaped(rate, {0.2, 0.0, 0.0}) == glm::dvec3(0.0));
    CHECK(shaped(rate, {0.0, -0.6, 0.0}).y == doctest::Approx(-0.25));
    CHECK(shaped(rate, {3.0, 4.0, 0.0}).x == doctest::Approx(0.6));
    CHECK(glm::length(shaped(rate, {3.0, 4.0, 0.0})) == doctest::Approx(1.0));
    CHECK(shaped(rate, {NAN, 0.0, 0.0}) == glm::dvec3(0.0));
}
