#pragma once
// A folder that is deleted when its owner is destroyed.

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr::cli {

struct TemporaryFolder {
    std::filesystem::path path;

    /// Creates a folder with a unique name that begins with `begins_with`, in the system's temporary folder. May fail.
    explicit TemporaryFolder(const std::string& begins_with)
    {
        std::string name = (std::filesystem::temp_directory_path() / (begins_with + "-XXXXXX")).string();
        if (!::mkdtemp(name.data())) fail(name, ": cannot be created: ", reason_of(errno));
        path = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder()
    {
        std::error_code ignored;  // files that cannot be removed stay there
        std::filesystem::remove_all(path, ignored);
    }
};

}  // namespace shvr::cli
