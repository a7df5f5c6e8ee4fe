#include "engine/workbench/models/preferences.h"

#include <algorithm>

#include "engine/remote/address.h"

namespace shvr::ui {

void Preferences::note_opened(const std::filesystem::path& path)
{
    const std::filesystem::path whole = whole_path(path);
    std::erase(recent, whole);
    recent.insert(recent.begin(), whole);
    recent.resize(std::min(recent.size(), MAX_RECENT));
}

}  // namespace shvr::ui
