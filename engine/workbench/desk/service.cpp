#include "engine/workbench/desk/service.h"

namespace shvr::ui {

Service::Service(Desk& desk)
    : desk_(desk),
      renderer_(desk.renderer),
      options_(desk.options),
      document_(desk.document),
      log_(desk.log),
      jobs_(desk.jobs),
      savers_(desk.savers)
{}

void Service::attempt(Attempt& state, const std::function<void()>& part)
{
    if (options_.now_s() < state.again_s) return;
    try {
        part();
    } catch (const DeviceLost&) {
        throw;
    } catch (const std::exception& error) {
        note_failure(state, told_of(error));
    }
}

void Service::note_failure(Attempt& state, const std::string& why)
{
    constexpr double AGAIN_S = 0.25, SAY_AGAIN_S = 1.0;
    const double now = options_.now_s();
    const bool is_known = state.failed_s > 0.0 && why == state.said && now - state.failed_s < SAY_AGAIN_S;
    if (!is_known) say(why, Weight::error);
    state = {.said = why, .failed_s = now, .again_s = now + AGAIN_S};
}

}  // namespace shvr::ui
