#pragma once
// Names of files that a task is to write, checked before any work. Any thread.

#include <filesystem>
#include <string>
#include <vector>

namespace shvr {

/// A name with none of `extensions` is wrong usage (UsageError), in which the option is called `option`; a folder that
/// is missing or not writable is an error. An empty `path` means that nothing is to be written and passes.
void check_output(const std::string& option, const std::filesystem::path& path,
                  const std::vector<std::string>& extensions);

}  // namespace shvr
