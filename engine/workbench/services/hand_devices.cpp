#include "engine/workbench/services/hand.h"

#include <algorithm>

namespace shvr::ui {

namespace {

constexpr double LOOK_EVERY_S = 2.0;

const DeviceListing* row_with_id(const std::vector<DeviceListing>& devices, const std::string& id)
{
    const auto found = std::ranges::find(devices, id, &DeviceListing::id);
    return found == devices.end() ? nullptr : &*found;
}

}  // namespace

void Hand::use_device(std::shared_ptr<HapticDevice> device, const std::string& name)
{
    is_given_device_ = true;
    DeviceListing row;
    row.id = "given";
    row.name = name;
    take_device(std::move(device), row);
}

void Hand::take_device(std::shared_ptr<HapticDevice> device, const DeviceListing& row)
{
    device_ = std::move(device);
    hand_.in_use = row.id;
    hand_.name = row.name;
    hand_.serial = row.serial;
    hand_.connection = row.connection;
    hand_.trouble.clear();
    hand_.is_puck = device_->caps().rate_control;
    if (!document_) return;
    document_->touch.use(device_, hand_.is_puck && keeper_.preferences().puck == PuckMoves::view);
    note_hand();
}

void Hand::leave_device()
{
    if (document_) document_->touch.use(nullptr);
    grab_.reset();
    device_.reset();
    HandView hand;
    hand.devices = std::move(hand_.devices);
    hand.has_looked = hand_.has_looked;
    hand.is_let_go = hand_.is_let_go;
    hand.recording = hand_.recording;
    hand_ = std::move(hand);
}

/// Returns the device that the user chose, or else the first usable one; null if there is none.
const DeviceListing* Hand::wanted_device() const
{
    const ChosenDevice& chosen = keeper_.preferences().device;
    for (const DeviceListing& row : hand_.devices) {
        if (row.kind == DeviceKind::mouse) continue;
        const bool is_it = chosen.name.empty() ? row.why_unusable.empty() && !refused_.contains(row.id)
                                               : row.name == chosen.name && row.serial == chosen.serial;
        if (is_it) return &row;
    }
    return nullptr;
}

void Hand::choose_device()
{
    if (is_given_device_ || !hand_.opening.empty()) return;
    if (device_ && !row_with_id(hand_.devices, hand_.in_use)) {
        say(name_in_words(hand_.name, hand_.serial) + " is gone; the mouse moves the probe", Weight::warning);
        leave_device();
    }
    const DeviceListing* const wanted = wanted_device();
    if (device_ || !wanted || refused_.contains(wanted->id)) return;
    if (!wanted->why_unusable.empty()) {
        refused_.insert(wanted->id);
        hand_.trouble = sentence(wanted->name, ": ", wanted->why_unusable);
        return say(hand_.trouble, Weight::warning);
    }
    hand_.opening = wanted->id;
    watch_->open(wanted->id);
}

/// Opens devices that are connected while the program runs, and closes those that are disconnected.
void Hand::follow_devices()
{
    if (!options_.has_servo || options_.is_script) return;
    if (!watch_) {
        DeviceSource source = options_.devices.list ? options_.devices : devices_of_machine(options_.allow_force);
        watch_ = std::make_unique<DeviceWatch>(std::move(source));
    }
    const double now = options_.now_s();
    if (now >= look_again_s_ && !watch_->is_busy()) {
        look_again_s_ = now + LOOK_EVERY_S;
        watch_->look();
    }
    DeviceWatch::News news = watch_->take();
    hand_.is_looking = watch_->is_busy() && !hand_.has_looked;
    if (!news.failure.empty() && news.failure != hand_.trouble) say(hand_.trouble = news.failure, Weight::warning);
    if (news.devices) {
        hand_.devices = std::move(*news.devices);
        hand_.has_looked = true;
        std::erase_if(refused_, [&](const std::string& id) { return !row_with_id(hand_.devices, id); });
    }
    if (news.opened) {
        const std::string id = std::exchange(hand_.opening, {});
        const DeviceListing* const row = row_with_id(hand_.devices, id);
        if (news.opened->device && row && !is_given_device_) {
            take_device(std::move(news.opened->device), DeviceListing(*row));
            say(sentence(name_in_words(hand_.name, hand_.serial),
                         document_->touch.is_mouse() ? " moves the view" : " moves the probe"));
        } else if (!news.opened->failure.empty()) {
            refused_.insert(id);
            hand_.trouble = news.opened->failure;
            say(hand_.trouble, Weight::warning);
        }
    }
    if (news.devices || news.opened) choose_device();
}

void Hand::act(const UseDevice& action)
{
    Preferences preferences = keeper_.preferences();
    const DeviceListing* const row = row_with_id(hand_.devices, action.device);
    if (!action.device.empty() && !row)
        fail("haptic device ", action.device, ": is not there; expected the id of a device that is listed");
    preferences.device = row ? ChosenDevice{row->name, row->serial} : ChosenDevice{};
    keeper_.prefer(std::move(preferences));
    refused_.clear();
    is_given_device_ = false;
    if (!row || row->id != hand_.in_use) {
        const DeviceListing wanted = row ? *row : DeviceListing{};
        leave_device();
        say(!row                               ? std::string("The first device that can be used moves the probe")
            : wanted.kind == DeviceKind::mouse ? std::string("The mouse moves the probe")
                                               : name_in_words(wanted.name, wanted.serial) + " is being opened");
    }
    if (watch_) choose_device();
}

void Hand::act(const FindDevices&)
{
    refused_.clear();
    look_again_s_ = 0.0;
    hand_.trouble.clear();
    say("Looking for haptic devices");
}

/// Reopens the device, which makes it calibrate. If calibration needs the user's help, a message says how.
void Hand::act(const CalibrateDevice&)
{
    if (!device_) fail("no haptic device is in use; expected one to calibrate");
    if (is_given_device_ || !watch_) fail(hand_.name, " is calibrated by the program that gave it");
    const std::string id = hand_.in_use;
    leave_device();
    hand_.opening = id;
    watch_->open(id);
    say("Calibrating: leave the stylus in its holder");
}

}  // namespace shvr::ui
