#include "engine/base/waits/waits.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/base/progress.h"

namespace shvr {

namespace {

thread_local const WaitsUntil* innermost = nullptr;
std::atomic<const std::atomic<bool>*> flag_of_program = nullptr;

}  // namespace

WaitsUntil::WaitsUntil(std::function<bool()> is_over) : is_over_(std::move(is_over)), outer_(innermost)
{
    innermost = this;
}

WaitsUntil::~WaitsUntil()
{
    innermost = outer_;
}

std::function<bool()> waits_of_this_thread()
{
    std::vector<std::function<bool()>> conditions;
    for (const WaitsUntil* scope = innermost; scope != nullptr; scope = scope->outer_)
        conditions.push_back(scope->is_over_);
    return [conditions] { return std::ranges::any_of(conditions, [](const auto& is_over) { return is_over(); }); };
}

void end_all_waits_by(const std::atomic<bool>& flag)
{
    flag_of_program = &flag;
}

bool wait_is_over()
{
    const std::atomic<bool>* const flag = flag_of_program;
    if (flag != nullptr && *flag) return true;
    for (const WaitsUntil* scope = innermost; scope != nullptr; scope = scope->outer_)
        if (scope->is_over_()) return true;
    return false;
}

void stop_if_wait_is_over()
{
    if (wait_is_over()) throw Stopped("stopped while waiting for a network");
}

}  // namespace shvr
