#include "haptics/hid/hid_recording.h"

#include <algorithm>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "haptics/hid/hid_profile.h"
#include "haptics/hid/hid_protocol.h"

using namespace shvr;

namespace {

/// Sends `reports` SpaceMouse reports, then falls silent or (`goes_away`) disconnects.
class Port : public HidPort {
public:
    Port(int reports, bool goes_away) : left_(reports), goes_away_(goes_away) {}
    int read(std::span<uint8_t> report, int) override
    {
        if (left_ == 0) return goes_away_ ? -1 : 0;
        report[0] = 1;
        std::fill_n(report.begin() + 1, 6, uint8_t(0));
        report[1] = uint8_t(left_--);
        return 7;
    }
    bool write(std::span<const uint8_t>) override
    {
        FAIL("a recorder writes nothing");
        return false;
    }
    int read_feature(uint8_t, std::span<uint8_t>) override { return 0; }

private:
    int left_;
    bool goes_away_;
};

std::string error_of(const std::string& text)
{
    try {
        parse_hid_recording(text, "x");
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

const std::string HEAD = R"({"format":"shvr_hid_reports","version":1,"vendor":"0x2988","product":"0x0304",)"
                         R"("name":"","descriptor":""})"
                         "\n";

}  // namespace

TEST_CASE("reports are recorded with their times, and read back as they were")
{
    HidRecording recording{.vendor = 0x256f, .product = 0xc635, .name = "Space \"Mouse\" \\", .descriptor = {5, 1}};
    Port port(100, true);
    CHECK_FALSE(record_reports(
        port, 10.0, [](size_t) { return true; }, recording));
    REQUIRE(recording.reports.size() == 100);
    const HidRecording read = parse_hid_recording(text_of(recording), "x");
    CHECK(read.vendor == 0x256f);
    CHECK(read.product == 0xc635);
    CHECK(read.name == recording.name);
    CHECK(read.descriptor == recording.descriptor);
    REQUIRE(read.reports.size() == 100);
    const HidProfile mouse = load_hid_profile("assets/devices/spacemouse.json");
    for (size_t i = 0; i < 100; ++i) {
        CHECK(read.reports[i].t_us == recording.reports[i].t_us);
        CHECK(read.reports[i].bytes == recording.reports[i].bytes);
        const auto input = decode(mouse, read.reports[i].bytes);
        REQUIRE(input);
        CHECK(input->rate->x == doctest::Approx(double(100 - i) / 350.0));
    }
}

TEST_CASE("a recording ends when its time is over, and when it is told to")
{
    HidRecording recording;
    Port port(5, false);
    CHECK(record_reports(
        port, 0.05, [](size_t) { return true; }, recording));
    CHECK(recording.reports.size() == 5);
    size_t asked = 0;
    Port endless(1 << 30, false);
    CHECK(record_reports(
        endless, 1e9, [&](size_t count) { return (asked = count) == 0; }, recording));
    CHECK(asked > 5);
    CHECK(std::ranges::is_sorted(recording.reports, {}, &HidRecordedReport::t_us));
}

TEST_CASE("what is wrong in a recording is said in one sentence")
{
    CHECK(error_of(HEAD + R"({"t_us":5,"bytes":"01ff"})").empty());
    CHECK(error_of("") == "x: is empty; expected a line about the device and one for each report");
    CHECK(error_of("{}") == "x:1: key format is missing; expected one of \"shvr_hid_reports\"");
    CHECK(error_of(HEAD + R"({"t_us":5,"bytes":"01f"})") ==
          "x:2: key bytes is \"01f\"; expected an even number of hexadecimal digits, at most 2048");
    CHECK(error_of(HEAD + R"({"t_us":5,"bytes":"0x"})").find("hexadecimal digits") != std::string::npos);
    CHECK(error_of(HEAD + "{\"t_us\":5,\"bytes\":\"\"}\n{\"t_us\":4,\"bytes\":\"\"}") ==
          "x:3: key t_us is 4; expected at least 5, the time before it");
    CHECK(error_of(HEAD + "{\"t_us\":5").find("x:2: is not JSON") == 0);
}

TEST_CASE("a device that is not there, and a file that is, are refused")
{
    const auto goes_on = [](size_t) { return true; };
    CHECK_THROWS_WITH_AS(record_hid_device("fffe:fffd", "assets/devices/README.md", 1.0, goes_on),
                         "assets/devices/README.md: exists; expected the name of a new file", Error);
    try {
        record_hid_device("fffe:fffd", "/nowhere/new.jsonl", 1.0, goes_on);
        CHECK(false);
    } catch (const Error& error) {
        CHECK(std::string(error.what()).find("fffe:fffd: is not plugged in; expected ids as in 2988:0304") == 0);
    }
}
