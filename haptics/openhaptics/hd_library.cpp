#include "haptics/openhaptics/hd_library.h"

#include <dlfcn.h>

#include <map>
#include <memory>
#include <mutex>

#include "engine/base/error.h"

namespace shvr {
namespace {

template <class Function>
void find(void* library, const std::string& name, const char* symbol, Function*& function)
{
    function = reinterpret_cast<Function*>(::dlsym(library, symbol));
    if (!function) fail(name, ": lacks the function ", symbol, "; expected OpenHaptics 3.4 or newer");
}

std::unique_ptr<HdLibrary> functions_of(void* library, const std::string& name)
{
    auto hd = std::make_unique<HdLibrary>();
    find(library, name, "hdInitDevice", hd->init_device);
    find(library, name, "hdDisableDevice", hd->disable_device);
    find(library, name, "hdMakeCurrentDevice", hd->make_current);
    find(library, name, "hdBeginFrame", hd->begin_frame);
    find(library, name, "hdEndFrame", hd->end_frame);
    find(library, name, "hdGetError", hd->get_error);
    find(library, name, "hdGetErrorString", hd->error_string);
    find(library, name, "hdEnable", hd->enable);
    find(library, name, "hdDisable", hd->disable);
    find(library, name, "hdGetDoublev", hd->get_doubles);
    find(library, name, "hdGetIntegerv", hd->get_integers);
    find(library, name, "hdGetString", hd->get_string);
    find(library, name, "hdSetDoublev", hd->set_doubles);
    find(library, name, "hdScheduleAsynchronous", hd->schedule);
    find(library, name, "hdUnschedule", hd->unschedule);
    find(library, name, "hdStartScheduler", hd->start_scheduler);
    find(library, name, "hdStopScheduler", hd->stop_scheduler);
    find(library, name, "hdCheckCalibration", hd->check_calibration);
    find(library, name, "hdUpdateCalibration", hd->update_calibration);
    return hd;
}

}  // namespace

const HdLibrary* load_hd_library(const std::string& name)
{
    static std::mutex mutex;
    static std::map<std::string, std::unique_ptr<HdLibrary>> loaded;
    const std::lock_guard lock(mutex);
    if (const auto found = loaded.find(name); found != loaded.end()) return found->second.get();
    void* const library = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) return nullptr;
    return (loaded[name] = functions_of(library, name)).get();
}

}  // namespace shvr
