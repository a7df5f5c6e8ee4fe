#include "tests/vm/uhid_device.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace shvr {

UhidDevice::UhidDevice(const Identity& identity, std::vector<uint8_t> feature)
    : feature_(std::move(feature)), descriptor_(::open("/dev/uhid", O_RDWR | O_CLOEXEC))
{
    constexpr uint16_t USB = 3;
    uhid_event event{};
    event.type = UHID_CREATE2;
    uhid_create2_req& create = event.u.create2;
    std::snprintf(reinterpret_cast<char*>(create.name), sizeof create.name, "%s", identity.name);
    std::snprintf(reinterpret_cast<char*>(create.uniq), sizeof create.uniq, "%s", identity.serial);
    create.rd_size = uint16_t(identity.descriptor.size());
    create.bus = USB;
    create.vendor = identity.vendor;
    create.product = identity.product;
    std::ranges::copy(identity.descriptor, create.rd_data);
    tell(event);
    thread_ = std::thread(&UhidDevice::run, this);
}

UhidDevice::~UhidDevice()
{
    is_running_ = false;
    thread_.join();
    uhid_event event{};
    event.type = UHID_DESTROY;
    tell(event);
    ::close(descriptor_);
}

void UhidDevice::send(std::span<const uint8_t> report)
{
    uhid_event event{};
    event.type = UHID_INPUT2;
    event.u.input2.size = uint16_t(report.size());
    std::ranges::copy(report, event.u.input2.data);
    tell(event);
}

std::array<uint8_t, 17> UhidDevice::last() const
{
    std::array<uint8_t, 17> bytes;
    for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = last_[i];
    return bytes;
}

void UhidDevice::tell(const uhid_event& event)
{
    if (::write(descriptor_, &event, sizeof event) != ssize_t(sizeof event)) std::printf("uhid refuses an event\n");
}

void UhidDevice::run()
{
    constexpr uint16_t NO_SUCH_REPORT = 5;  // EIO
    while (is_running_) {
        pollfd each{descriptor_, POLLIN, 0};
        if (::poll(&each, 1, 2) <= 0) continue;
        uhid_event event{};
        if (::read(descriptor_, &event, sizeof event) <= 0) continue;
        if (event.type == UHID_OUTPUT) {
            for (size_t i = 0; i < last_.size(); ++i) last_[i] = event.u.output.data[i];
            ++outputs_;
        }
        if (event.type == UHID_GET_REPORT) {
            uhid_event answer{};
            answer.type = UHID_GET_REPORT_REPLY;
            answer.u.get_report_reply.id = event.u.get_report.id;
            answer.u.get_report_reply.err = feature_.empty() ? NO_SUCH_REPORT : 0;
            answer.u.get_report_reply.size = uint16_t(feature_.size());
            std::ranges::copy(feature_, answer.u.get_report_reply.data);
            tell(answer);
        }
    }
}

}  // namespace shvr
