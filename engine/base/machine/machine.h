#pragma once
// The processors and the memory that this process was given: by affinity (taskset, Slurm), by control groups (Slurm,
// containers, systemd) and by limits of the shell. Defaults follow them. Any thread.

#include <cstdint>
#include <filesystem>
#include <optional>

namespace shvr {

/// Number of processors that the process may use, rounded up where a control group grants a share of one; at least 1.
int processors_allowed();
/// The lowest limit of memory among the control groups of the process and its address space; null: none.
std::optional<uint64_t> memory_limit();
/// The limit, or the machine's memory where that is less.
uint64_t memory_allowed();

/// Limits by control groups alone, of version 1 or 2; `root`: the folder of proc and sys.
struct GroupLimits {
    std::optional<double> processors{};
    std::optional<uint64_t> memory_bytes{};
};
GroupLimits group_limits(const std::filesystem::path& root = "/");

}  // namespace shvr
