#pragma once
// Saves pictures of the view: as shown, once the view is sharp, or larger. A larger picture is rendered part by part
// while nothing else needs the device, and written at the same time. Compression is slow and runs on a thread of its
// own; all other work runs on the main thread.

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "engine/live/screen.h"
#include "engine/picture/picture_file.h"
#include "engine/workbench/document/shots.h"
#include "engine/workbench/sight/figure.h"

namespace shvr::ui {

class Screenshots {
public:
    /// Requests a picture of the view as shown, to be saved once the view is sharp.
    void take() { is_wanted_ = true; }
    /// Returns the texts to store in the file of a picture.
    using Texts = std::function<PictureTexts(const std::filesystem::path& picture)>;
    /// Begins a large picture. `stem`: see advance(). `figure`: drawn over it. Fails if the file cannot be written.
    void take_large(const std::filesystem::path& stem, Renderer& renderer, const Session& session, const Camera& camera,
                    const RenderOptions& options, const Texts& texts, Figure figure);
    /// Begins a figure or a movie, and cancels the large picture in progress, if any.
    void take(std::unique_ptr<Shot> shot) { large_ = std::move(shot); }
    /// Cancels a large picture, a figure or a movie in progress. Call this before its volume changes or closes.
    void drop_large() { large_.reset(); }
    bool has_large() const { return large_ != nullptr; }
    /// Returns the large picture, figure or movie in progress; null: none.
    const Shot* large() const { return large_.get(); }
    bool is_writing() const { return written_.valid(); }

    struct Turn {
        std::string said;      ///< message for the user; empty: none
        std::string progress;  ///< likewise, but replaced as it changes
    };
    /// Call this every frame. `stem`: start of the file's name, "scan" for scan-view-1.png. `is_still`: the device is
    /// idle. `figure`: returns the drawing over a picture as shown. If a picture cannot be made, cancels it and fails.
    Turn advance(Screen& screen, const std::filesystem::path& stem, bool is_still, const Texts& texts,
                 const std::function<Figure()>& figure);
    /// Waits until the last picture is written.
    void wait() const;

private:
    std::filesystem::path free_path(const std::filesystem::path& stem) const;
    void write(Image8 image, const std::filesystem::path& stem, const Texts& texts, Figure figure);
    Turn advance_large();

    bool is_wanted_ = false;
    std::unique_ptr<Shot> large_;       ///< in progress
    std::future<std::string> written_;  ///< message about it
};

}  // namespace shvr::ui
