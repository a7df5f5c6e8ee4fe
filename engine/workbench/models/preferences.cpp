#include "engine/workbench/models/preferences.h"

#include <algorithm>

namespace shvr::ui {

void Preferences::note_opened(const std::filesystem::path& path)
{
    const std::filesystem::path whole = std::filesystem::absolute(path).lexically_normal();
    std::erase(recent, whole);
    recent.insert(recent.begin(), whole);
    recent.resize(std::min(recent.size(), MAX_RECENT));
}

}  // namespace shvr::ui
