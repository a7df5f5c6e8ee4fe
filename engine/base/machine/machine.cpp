#include "engine/base/machine/machine.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

/// Groups of version 1 without a limit state 2^63 bytes, rounded down to whole pages.
constexpr int64_t NO_LIMIT = int64_t{1} << 62;

template <class Value>
void take_least(std::optional<Value>& least, Value value)
{
    least = std::min(least.value_or(value), value);
}

/// The file's words as numbers; a word that is none ("max") is null.
std::vector<std::optional<int64_t>> numbers_in(const fs::path& file)
{
    std::ifstream stream(file);
    std::vector<std::optional<int64_t>> numbers;
    for (std::string word; stream >> word;) numbers.push_back(whole_of(word));
    return numbers;
}

std::optional<int64_t> number_in(const fs::path& file)
{
    const std::vector<std::optional<int64_t>> numbers = numbers_in(file);
    return numbers.empty() ? std::nullopt : numbers.front();
}

void take_processors(GroupLimits& limits, std::optional<int64_t> quota, std::optional<int64_t> period)
{
    if (quota && period && *quota > 0 && *period > 0) take_least(limits.processors, double(*quota) / double(*period));
}

void take_memory(GroupLimits& limits, std::optional<int64_t> bytes)
{
    if (bytes && *bytes > 0 && *bytes < NO_LIMIT) take_least(limits.memory_bytes, uint64_t(*bytes));
}

/// Calls `take` with the folder of a group and of each group above it: each of them limits.
void for_each_above(const fs::path& mount, const fs::path& group, const std::function<void(const fs::path&)>& take)
{
    for (fs::path at = group.relative_path();; at = at.parent_path()) {
        take(mount / at);
        if (at.empty() || at == at.parent_path()) break;
    }
}

}  // namespace

GroupLimits group_limits(const fs::path& root)
{
    GroupLimits limits;
    const fs::path mounts = root / "sys/fs/cgroup";
    std::ifstream groups(root / "proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {  // "0::/a" or "4:cpu,cpuacct:/a"
        const size_t first = line.find(':'), second = line.find(':', std::min(first, line.size() - 1) + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const fs::path group = line.substr(second + 1);
        if (controllers == ",,")
            for_each_above(mounts, group, [&](const fs::path& folder) {
                const std::vector<std::optional<int64_t>> share = numbers_in(folder / "cpu.max");
                if (share.size() == 2) take_processors(limits, share[0], share[1]);
                take_memory(limits, number_in(folder / "memory.max"));
            });
        if (controllers.find(",cpu,") != std::string::npos)
            for_each_above(mounts / "cpu", group, [&](const fs::path& folder) {
                take_processors(limits, number_in(folder / "cpu.cfs_quota_us"),
                                number_in(folder / "cpu.cfs_period_us"));
            });
        if (controllers.find(",memory,") != std::string::npos)
            for_each_above(mounts / "memory", group, [&](const fs::path& folder) {
                take_memory(limits, number_in(folder / "memory.limit_in_bytes"));
            });
    }
    return limits;
}

int processors_allowed()
{
    int count = int(std::thread::hardware_concurrency());
    cpu_set_t allowed;
    if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) count = CPU_COUNT(&allowed);
    if (const std::optional<double> share = group_limits().processors)
        count = int(std::min(double(count), std::ceil(*share)));
    return std::max(count, 1);
}

std::optional<uint64_t> memory_limit()
{
    std::optional<uint64_t> least = group_limits().memory_bytes;
    rlimit space{};
    if (::getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
        take_least(least, uint64_t(space.rlim_cur));
    return least;
}

uint64_t memory_allowed()
{
    const uint64_t all = uint64_t(::sysconf(_SC_PHYS_PAGES)) * uint64_t(::sysconf(_SC_PAGESIZE));
    return std::min(all, memory_limit().value_or(all));
}

}  // namespace shvr
