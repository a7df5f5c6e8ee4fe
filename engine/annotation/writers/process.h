#pragma once
// Identifies this computer and its processes, so that other processes can tell whether one has ended. Any thread.

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace shvr {

std::string host_name();

/// Identifies the boot of the running kernel: changes with each restart. Empty if unknown.
std::string boot_name();
/// The PID namespace of this process, since containers have their own process numbers. 0: unknown.
uint64_t process_space();

/// When a process began, in kernel ticks since boot. Together with its number, this identifies a process. Null if the
/// process has ended, even if its parent has not waited for it yet; 0 if the time cannot be determined.
std::optional<uint64_t> start_of(pid_t process);

/// Whether a folder is on a local disk, so that every process with access to it runs on this computer's present
/// kernel.
bool is_on_local_disk(const std::filesystem::path& folder);

}  // namespace shvr
