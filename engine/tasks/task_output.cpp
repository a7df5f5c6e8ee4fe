#include "engine/tasks/task_output.h"

#include <unistd.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

void check_output(const std::string& option, const std::filesystem::path& path,
                  const std::vector<std::string>& extensions)
{
    if (path.empty()) return;
    const std::string extension = lower_case(path.extension().string()), name = path.string();
    if (std::ranges::find(extensions, extension) == extensions.end()) {
        std::string all;
        for (const std::string& known : extensions) all += (all.empty() ? "" : ", ") + known;
        throw UsageError(sentence(option, " is '", name, "'; expected a name that ends in one of: ", all));
    }
    const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        fail(name, ": cannot be written: there is no folder ", folder.string());
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        fail(name, ": cannot be written: the folder ", folder.string(), " may not be written to");
    if (std::filesystem::is_directory(path, ignored)) fail(name, ": is a folder; expected the name of a file");
}

}  // namespace shvr
