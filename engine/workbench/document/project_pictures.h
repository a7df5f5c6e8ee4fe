#pragma once
// Takes small pictures of what is open, for the start page: of the first sharp view, and after each save. A thread
// shrinks and writes them, and removes those of projects that are no longer listed. Main thread.

#include <filesystem>
#include <future>
#include <vector>

#include "engine/base/image.h"
#include "engine/live/screen.h"

namespace shvr::ui {

/// Returns the middle of a picture in the shape of project_picture.h, shrunk to its size by averages.
Image8 project_picture_of(const Image8& picture);

class ProjectPictures {
public:
    /// Returns whether a picture is wanted now. `opening`: number of the opening; `is_saved`: nothing is unsaved.
    bool is_wanted(uint64_t opening, bool is_saved);
    /// Takes the picture of this opening. `recent`: paths that are listed, that of what is open first.
    void take(uint64_t opening, Screen& screen, const std::filesystem::path& folder,
              std::vector<std::filesystem::path> recent);

private:
    uint64_t opening_ = 0;  ///< the opening of which a picture was taken; 0: none
    bool was_saved_ = true;
    std::future<void> written_;
};

}  // namespace shvr::ui
