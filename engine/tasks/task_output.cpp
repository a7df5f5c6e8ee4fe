#include "engine/tasks/task_output.h"

#include <unistd.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

void expect_writable(const std::string& name, const std::filesystem::path& folder)
{
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        fail(name, ": cannot be written: the folder ", folder.string(), " may not be written to");
}

}  // namespace

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
    check_output_place(path);
}

void check_output_place(const std::filesystem::path& path)
{
    const std::string name = path.string();
    const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        fail(name, ": cannot be written: there is no folder ", folder.string());
    expect_writable(name, folder);
    if (std::filesystem::is_directory(path, ignored)) fail(name, ": is a folder; expected the name of a file");
}

void check_output_is_not(const std::filesystem::path& input, const std::filesystem::path& output)
{
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (input.empty() || output.empty() || !fs::exists(output, ignored)) return;
    // A Zarr image may contain other images; in other folders each file is a slice.
    const auto is_zarr = [&](const char* name) { return fs::exists(input / name, ignored); };
    const char* const zarr[] = {".zattrs", ".zgroup", ".zarray", "zarr.json"};
    const std::string extension = lower_case(output.extension().string());
    const bool is_slice = (extension == ".tif" || extension == ".tiff") && fs::is_directory(input, ignored) &&
                          std::ranges::none_of(zarr, is_zarr) &&
                          fs::equivalent(fs::absolute(output).parent_path(), input, ignored);
    if (is_slice || fs::equivalent(output, input, ignored))
        fail(output.string(), ": is read", is_slice ? ", as a part of " + input.string() : std::string(),
             "; expected another name, since it would be lost");
}

void check_output_folder(const std::filesystem::path& path)
{
    std::filesystem::path folder = std::filesystem::absolute(path).lexically_normal();
    std::error_code ignored;
    while (!std::filesystem::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
    if (!std::filesystem::is_directory(folder, ignored))
        fail(path.string(), ": cannot be written: ", folder.string(), " is no folder");
    expect_writable(path.string(), folder);
}

}  // namespace shvr
