#pragma once
// Identifies this computer and processes, so that other processes can tell whether one of them has ended. Any thread.

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace shvr {

std::string host_name();

/// Identifies the boot of the running kernel: differs after each restart. Empty if that cannot be determined.
std::string boot_name();
/// The PID namespace in which this process's number is unique: containers have their own. 0: not known.
uint64_t process_space();

/// When a process began, in kernel ticks since boot; with the process's number, this identifies the process. Null if
/// the process has ended (even if its parent has not waited for it yet); 0 if its start cannot be determined.
std::optional<uint64_t> start_of(pid_t process);

/// Whether a folder is on a disk of one computer, so that every process that can reach it runs on that computer's
/// present kernel.
bool is_on_local_disk(const std::filesystem::path& folder);

}  // namespace shvr
