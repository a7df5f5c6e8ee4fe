#include "engine/base/assets.h"

#include <cstdlib>
#include <system_error>
#include <vector>

namespace shvr {

namespace {

/// Returns an environment variable if it holds an absolute path, else an empty path: XDG says to ignore relative ones.
std::filesystem::path folder_from(const char* variable)
{
    const char* const value = std::getenv(variable);
    return value && *value == '/' ? std::filesystem::path(value) : std::filesystem::path();
}

std::filesystem::path user_folder(const char* variable, const char* below_home)
{
    if (const std::filesystem::path folder = folder_from(variable); !folder.empty()) return folder / "shvr";
    const std::filesystem::path home = folder_from("HOME");
    return home.empty() ? home : home / below_home / "shvr";
}

std::filesystem::path program_folder()
{
    std::error_code unknown;
    return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
}

}  // namespace

std::filesystem::path asset_folder(const std::string& name)
{
    std::vector<std::filesystem::path> candidates;
    if (const char* assets = std::getenv("SHVR_ASSETS")) candidates.emplace_back(assets);
    std::error_code unknown;
    const std::filesystem::path program = program_folder();
    candidates.push_back(program / "../share/shvr");
    candidates.push_back(program / "../../assets");
    for (const std::filesystem::path& candidate : candidates)
        if (std::filesystem::is_directory(candidate / name, unknown)) return candidate / name;
    return {};
}

std::filesystem::path manual_page()
{
    const std::filesystem::path page = "share/doc/shvr/manual/index.html", program = program_folder();
    const std::filesystem::path installed = (program / ".." / page).lexically_normal();
    std::error_code unknown;
    for (const std::filesystem::path& candidate : {installed, program / "package" / page})
        if (std::filesystem::is_regular_file(candidate, unknown)) return candidate;
    return installed;
}

std::filesystem::path config_folder()
{
    return user_folder("XDG_CONFIG_HOME", ".config");
}

std::filesystem::path cache_folder()
{
    return user_folder("XDG_CACHE_HOME", ".cache");
}

}  // namespace shvr
