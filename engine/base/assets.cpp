#include "engine/base/assets.h"

#include <cstdlib>
#include <system_error>
#include <vector>

namespace shvr {

std::filesystem::path asset_folder(const std::string& name)
{
    std::vector<std::filesystem::path> candidates;
    if (const char* assets = std::getenv("SHVR_ASSETS")) candidates.emplace_back(assets);
    std::error_code unknown;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
    candidates.push_back(program / "../share/shvr");
    candidates.push_back(program / "../../assets");
    for (const std::filesystem::path& candidate : candidates)
        if (std::filesystem::is_directory(candidate / name, unknown)) return candidate / name;
    return {};
}

}  // namespace shvr
