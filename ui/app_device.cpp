// The window's graphics device: attached at the start, and re-created after a loss.

#include <chrono>
#include <thread>

#include "ui/app.h"

namespace shvr::ui {

void App::attach()
{
    window_.attach(renderer_->device(), renderer_->memory());
    attached_.reset(&window_);
}

/// Retries for a while, since a driver needs a moment after a reset. The document stays open; only unrecorded changes
/// are lost. If no device can be created, the program ends with the reason, and unsaved work is in the journal.
void App::restart_device(const std::string& why)
{
    constexpr int TRIES = 5;
    constexpr std::chrono::seconds PAUSE{1};
    bench_->say(why, Weight::error);
    const auto make_anew = [this] {
        attached_.reset();
        renderer_->restart();
        attach();
    };
    for (int tries = 1;; ++tries) {
        try {
            return bench_->restart_device(make_anew);
        } catch (const Error& error) {
            const bool has_device = attached_ != nullptr && dynamic_cast<const DeviceLost*>(&error) == nullptr;
            if (has_device) return bench_->say(error.what(), Weight::error);
            if (tries == TRIES) fail("the graphics device was lost and cannot be started again: ", error.what());
        }
        std::this_thread::sleep_for(PAUSE);
    }
}

}  // namespace shvr::ui
