#include "engine/workbench/models/preferences.h"

#include <algorithm>

#include "engine/remote/address.h"

namespace shvr::ui {

namespace {

/// Returns the path under which something is listed: a project has one, whether its folder or its session was opened.
std::filesystem::path listed(const std::filesystem::path& path)
{
    std::filesystem::path whole = whole_path(path);
    if (leads_to_network(whole)) return whole;
    if (!whole.has_filename()) whole = whole.parent_path();
    const bool is_in_project = whole.filename() == "session.json" && whole.parent_path().filename() == "shvr";
    return is_in_project ? whole.parent_path().parent_path() : whole;
}

}  // namespace

void Preferences::note_opened(const std::filesystem::path& path)
{
    recent.insert(recent.begin(), path);
    std::vector<std::filesystem::path> once;
    for (const std::filesystem::path& each : recent)
        if (const std::filesystem::path name = listed(each); std::ranges::find(once, name) == once.end())
            once.push_back(name);
    once.resize(std::min(once.size(), MAX_RECENT));
    recent = std::move(once);
}

}  // namespace shvr::ui
