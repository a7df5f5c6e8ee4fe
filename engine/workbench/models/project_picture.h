#pragma once
// Names of the small pictures of projects that the start page shows. Pure; any thread.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace shvr::ui {

inline constexpr int PROJECT_PICTURE_WIDTH = 192, PROJECT_PICTURE_HEIGHT = 120;

/// Returns the file in `folder` with the picture of what was opened under this path (Preferences::recent).
inline std::filesystem::path project_picture_file(const std::filesystem::path& folder,
                                                  const std::filesystem::path& path)
{
    uint64_t hash = 14695981039346656037ull;  // FNV-1a
    for (const char each : path.native()) hash = (hash ^ uint8_t(each)) * 1099511628211ull;
    char name[24];
    std::snprintf(name, sizeof name, "%016llx.png", static_cast<unsigned long long>(hash));
    return folder / name;
}

}  // namespace shvr::ui
