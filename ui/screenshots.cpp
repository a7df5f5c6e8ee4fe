#include "ui/screenshots.h"

#include <chrono>
#include <utility>

#include "engine/base/image_file.h"

namespace shvr::ui {

namespace {

/// "scan-view-1.png", or with the first free number.
std::filesystem::path free_path(const std::filesystem::path& stem)
{
    for (int number = 1;; ++number) {
        std::filesystem::path path = sentence(stem.string(), "-view-", number, ".png");
        if (!std::filesystem::exists(path)) return path;
    }
}

}  // namespace

Screenshots::Turn Screenshots::advance(Screen& screen, const std::filesystem::path& stem, bool is_still)
{
    if (is_writing()) {
        if (written_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
        return {.said = written_.get(), .progress = {}};
    }
    if (!screen.complete()) return {};
    if (std::exchange(is_wanted_, false)) {
        write(screen.read_back(), stem);
        return {};
    }
    return large_ && is_still ? advance_large(stem) : Turn{};
}

Screenshots::Turn Screenshots::advance_large(const std::filesystem::path& stem)
{
    std::unique_ptr<PictureJob> job = std::move(large_);  // dropped here if it fails
    if (job->is_done()) {
        write(to_image8(job->take().image), stem);
        return {};
    }
    job->step();
    const int percent = int(100.0 * job->progress());
    large_ = std::move(job);
    return {.said = {}, .progress = sentence("Large screenshot: ", percent, " %")};
}

void Screenshots::write(Image8 image, const std::filesystem::path& stem)
{
    written_ = std::async(std::launch::async, [image = std::move(image), path = free_path(stem)] {
        try {
            write_png(path, image);
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
