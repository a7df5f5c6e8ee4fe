#include "engine/workbench/document/screenshots.h"

#include <chrono>
#include <utility>

#include "engine/base/image_file.h"

namespace shvr::ui {

/// Returns a path such as "scan-view-1.png" with the first unused number. A large picture in progress has one in use.
std::filesystem::path Screenshots::free_path(const std::filesystem::path& stem) const
{
    for (int number = 1;; ++number) {
        std::filesystem::path path = sentence(stem.string(), "-view-", number, ".png");
        if (!std::filesystem::exists(path) && !(large_ && path == large_->path())) return path;
    }
}

void Screenshots::take_large(const std::filesystem::path& stem, Renderer& renderer, const Session& session,
                             const Camera& camera, const RenderOptions& options, const Texts& texts, Figure figure)
{
    large_.reset();
    const std::filesystem::path path = free_path(stem);
    large_ = std::make_unique<PictureShot>(
        path, renderer, session, camera, options, texts(path), std::move(figure),
        PictureShot::Words{.name = "large screenshot", .said = "Screenshot: " + path.string()});
}

Screenshots::Turn Screenshots::advance(Screen& screen, const std::filesystem::path& stem, bool is_still,
                                       const Texts& texts, const std::function<Figure()>& figure)
{
    if (is_writing()) {
        if (written_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
        return {.said = written_.get(), .progress = {}};
    }
    // A large picture sets the view while it waits for bricks, and the light while it has a look of its own. If the
    // screen then renewed the light for its own look between parts, each would undo the other's work.
    const bool was_held = screen.is_held();
    screen.hold(was_held && large_ && large_->has_own_look() && !is_wanted_);
    if (!screen.complete() && (!was_held || is_wanted_)) return {};
    if (screen.complete() && std::exchange(is_wanted_, false)) {
        write(screen.read_back(), stem, texts, figure());
        return {};
    }
    if (!large_ || !is_still) return {};
    const Turn turn = advance_large();
    const bool waits = large_ && large_->is_waiting();
    screen.hold(waits || (large_ && large_->has_own_look()));
    return waits ? Turn{} : turn;  // nothing new to tell
}

Screenshots::Turn Screenshots::advance_large()
{
    if (large_->is_writing()) return {};
    std::unique_ptr<Shot> shot = std::move(large_);  // dropped here if it fails
    shot->step();
    if (shot->is_done()) return {.said = shot->said(), .progress = {}};
    large_ = std::move(shot);
    return {.said = {}, .progress = large_->progress_in_words()};
}

void Screenshots::write(Image8 image, const std::filesystem::path& stem, const Texts& texts, Figure figure)
{
    const std::filesystem::path path = free_path(stem);
    written_ = std::async(std::launch::async,
                          [image = std::move(image), figure = std::move(figure), path, kept = texts(path)]() mutable {
                              try {
                                  draw(figure, image);
                                  write_png(path, image, kept);
                                  return "Screenshot: " + path.string();
                              } catch (const Error& error) {
                                  return std::string(error.what());
                              }
                          });
}

void Screenshots::wait() const
{
    if (written_.valid()) written_.wait();
}

}  // namespace shvr::ui
