#include "engine/workbench/forms/form_names.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "engine/base/text.h"

namespace shvr::ui {

namespace fs = std::filesystem;

fs::path stem_of(fs::path path)
{
    if (!path.has_filename()) path = path.parent_path();
    path.replace_extension();
    for (const char* half : {".session", ".nii", ".ome", ".seg"})
        if (path.extension() == half) path.replace_extension();
    return path;
}

fs::path base_of(const Model& model)
{
    if (!model.is_open) return {};
    fs::path path = model.session_path.empty() ? model.session.volume_path : model.session_path;
    if (path.parent_path().filename() == "shvr") path = path.parent_path().parent_path();  // of a project
    return stem_of(std::move(path));
}

fs::path placed(const std::string& typed, const fs::path& folder)
{
    if (typed.empty()) return {};
    const char* const home = std::getenv("HOME");
    if (home && (typed == "~" || typed.starts_with("~/")))
        return fs::path(home) / typed.substr(typed.size() > 1 ? 2 : 1);
    const fs::path path = typed;
    return path.is_absolute() || folder.empty() ? path : (folder / path).lexically_normal();
}

fs::path placed_new(const std::string& typed, const fs::path& folder)
{
    return placed(std::string(trimmed(typed)), folder);
}

std::string bytes_in_words(double bytes)
{
    constexpr const char* UNITS[] = {"bytes", "kB", "MB", "GB", "TB", "PB"};
    size_t unit = 0;
    while (bytes >= 999.5 && unit + 1 < std::size(UNITS)) bytes /= 1000.0, ++unit;
    char text[32];
    std::snprintf(text, sizeof text, unit > 0 && bytes < 9.95 ? "%.1f %s" : "%.0f %s", bytes, UNITS[unit]);
    return text;
}

}  // namespace shvr::ui
