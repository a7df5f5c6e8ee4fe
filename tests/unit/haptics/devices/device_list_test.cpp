#include "haptics/devices/device_list.h"

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/inverse3_service.h"

using namespace shvr;

namespace {

DeviceOptions nothing_installed()
{
    DeviceOptions options;
    options.inverse3.port = options.inverse3.event_port = 1;
    options.openhaptics.library = "libthere_is_none.so";
    return options;
}

std::string stub_library(const std::string& name)
{
    return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "stubs" / name).string();
}

}  // namespace

TEST_CASE("where nothing is installed the mouse is listed, and nothing is opened")
{
    const DeviceOptions options = nothing_installed();
    const std::vector<DeviceListing> rows = list_devices(options);
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].kind == DeviceKind::mouse);
    CHECK(rows[0].why_unusable.empty());
    CHECK_FALSE(rows[0].has_force);
    CHECK(open_device(options, "mouse") == nullptr);
    CHECK(open_first_device(options) == nullptr);
    CHECK_THROWS_WITH_AS(open_device(options, "inverse3:049D"),
                         "haptic device inverse3:049D: is not there; expected the id of a device that is listed",
                         Error);
    CHECK_THROWS_AS(open_device(options, "nonsense"), Error);
}

TEST_CASE("devices of every back end are listed, and opened by their ids")
{
    Inverse3Service service;
    DeviceOptions options = nothing_installed();
    options.inverse3.port = service.port();
    options.inverse3.event_port = service.event_port();
    options.inverse3.connect_timeout = std::chrono::milliseconds(3000);  // of a busy machine
    options.openhaptics.library = stub_library("libhd_stub.so");
    const std::vector<DeviceListing> rows = list_devices(options);
    REQUIRE(rows.size() == 3);
    CHECK(rows[0].kind == DeviceKind::inverse3);
    CHECK(rows[0].id == "inverse3:049D");
    CHECK(rows[0].serial == "049D");
    CHECK(rows[0].connection == "service on port " + std::to_string(service.port()));
    CHECK(rows[0].why_unusable.empty());
    CHECK(rows[1].kind == DeviceKind::openhaptics);
    CHECK(rows[1].why_unusable.empty());
    CHECK(service.heard().empty());  // listing sends nothing
    for (const DeviceListing& row : rows) {
        const auto device = open_device(options, row.id);
        CHECK((device != nullptr) == (row.kind != DeviceKind::mouse));
        if (device) CHECK_FALSE(device->caps().outputs_force);
    }
    options.allow_force = true;
    CHECK(open_device(options, rows[0].id)->caps().outputs_force);
    CHECK(open_first_device(options)->caps().stiffness_limit == 250.0);  // the Inverse3
}

TEST_CASE("why a device cannot be used is in its row, and another back end is tried")
{
    Inverse3Service service;
    service.set_inventory(R"({"inverse3":[]})");
    DeviceOptions options = nothing_installed();
    options.inverse3.port = service.port();
    options.inverse3.event_port = service.event_port();
    options.inverse3.connect_timeout = std::chrono::milliseconds(3000);
    CHECK(list_devices(options)[0].why_unusable == "it lists no Inverse3");
    CHECK_THROWS_AS(open_first_device(options), Error);
    options.openhaptics.library = stub_library("libhd_stub.so");
    CHECK(open_first_device(options) != nullptr);
    options.openhaptics.library = stub_library("libhd_partial.so");
    CHECK(list_devices(options)[1].why_unusable.find("lacks the function") != std::string::npos);
}

TEST_CASE("a HID device's row says what its profile and its node allow")
{
    HidProfile profile;
    profile.name = "Arm";
    profile.note = "It is recognised only.";
    const HidListing device{.path = "/dev/hidraw9", .serial = "S1"};
    DeviceListing row = listing_of(device, profile, true);
    CHECK(row.id == "hid:/dev/hidraw9");
    CHECK(row.name == "Arm");
    CHECK(row.why_unusable == "It is recognised only.");
    profile.inputs.emplace_back();
    row = listing_of(device, profile, true);
    CHECK(row.why_unusable.empty());
    CHECK(row.why_no_force == "its profile has no output report");
    profile.output.emplace();
    CHECK(listing_of(device, profile, true).why_no_force == "its profile is not verified");
    profile.verified = true;
    CHECK(listing_of(device, profile, true).has_force);
    CHECK(listing_of(device, profile, false).why_unusable.find("70-shvr-haptics.rules") != std::string::npos);
}
