#pragma once
// Pictures of the view in files: of what is shown, once it is sharp, and larger ones, part by part while nothing else
// is to be drawn. A thread packs the file, which takes long; all else is the main thread's.

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "engine/live/screen.h"
#include "engine/picture/picture_job.h"

namespace shvr::ui {

class Screenshots {
public:
    /// A picture of what is shown.
    void take() { is_wanted_ = true; }
    void take_large(std::unique_ptr<PictureJob> job) { large_ = std::move(job); }
    /// No large one: its volume goes, or changes.
    void drop_large() { large_.reset(); }
    bool has_large() const { return large_ != nullptr; }
    bool is_writing() const { return written_.valid(); }

    struct Turn {
        std::string said;      ///< for the person; empty: nothing
        std::string progress;  ///< likewise, but not worth keeping
    };
    /// To be called at every turn. `stem`: of the file, "scan" for scan-view-1.png. `is_still`: nobody waits for the
    /// device. Fails where a picture cannot be made; then it is given up.
    Turn advance(Screen& screen, const std::filesystem::path& stem, bool is_still);
    /// Waits until the last one is written.
    void wait() const;

private:
    void write(Image8 image, const std::filesystem::path& stem);
    Turn advance_large(const std::filesystem::path& stem);

    bool is_wanted_ = false;
    std::unique_ptr<PictureJob> large_;  ///< under way
    std::future<std::string> written_;   ///< what to say of it
};

}  // namespace shvr::ui
