#include "engine/workbench/document/project_pictures.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/image_file.h"
#include "engine/workbench/models/project_picture.h"

namespace shvr::ui {

namespace {

/// Writes the picture, and removes all others that belong to none of the listed paths.
void write(const Image8& picture, const std::filesystem::path& folder, const std::vector<std::filesystem::path>& recent)
{
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    write_png(project_picture_file(folder, recent.front()), project_picture_of(picture));
    std::set<std::filesystem::path> kept;
    for (const std::filesystem::path& path : recent) kept.insert(project_picture_file(folder, path));
    for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".png" && !kept.contains(entry.path()))
            std::filesystem::remove(entry.path(), ignored);
}

}  // namespace

Image8 project_picture_of(const Image8& picture)
{
    constexpr int WIDTH = PROJECT_PICTURE_WIDTH, HEIGHT = PROJECT_PICTURE_HEIGHT;
    Image8 small{.width = WIDTH, .height = HEIGHT, .rgba = std::vector<uint8_t>(size_t(4 * WIDTH * HEIGHT), 255)};
    if (picture.width < 1 || picture.height < 1) return small;
    const double scale = std::min(double(picture.width) / WIDTH, double(picture.height) / HEIGHT);
    const double left = 0.5 * (picture.width - scale * WIDTH), top = 0.5 * (picture.height - scale * HEIGHT);
    const auto range = [](double begin, double end, int size) {
        const int first = std::clamp(int(begin), 0, size - 1);
        return std::pair(first, std::clamp(int(end), first + 1, size));
    };
    for (int y = 0; y < HEIGHT; ++y)
        for (int x = 0; x < WIDTH; ++x) {
            const auto [x0, x1] = range(left + x * scale, left + (x + 1) * scale, picture.width);
            const auto [y0, y1] = range(top + y * scale, top + (y + 1) * scale, picture.height);
            uint32_t sums[3] = {};
            for (int v = y0; v < y1; ++v)
                for (int u = x0; u < x1; ++u)
                    for (int c = 0; c < 3; ++c)
                        sums[c] += picture.rgba[4 * (size_t(v) * size_t(picture.width) + size_t(u)) + size_t(c)];
            const auto count = uint32_t((x1 - x0) * (y1 - y0));
            for (int c = 0; c < 3; ++c)
                small.rgba[4 * (size_t(y) * WIDTH + size_t(x)) + size_t(c)] = uint8_t((sums[c] + count / 2) / count);
        }
    return small;
}

bool ProjectPictures::is_wanted(uint64_t opening, bool is_saved)
{
    const bool was_saved = std::exchange(was_saved_, is_saved);
    if (is_saved && !was_saved) opening_ = 0;
    const bool is_writing = written_.valid() && written_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
    return opening_ != opening && !is_writing;
}

void ProjectPictures::take(uint64_t opening, Screen& screen, const std::filesystem::path& folder,
                           std::vector<std::filesystem::path> recent)
{
    opening_ = opening;
    written_ = std::async(std::launch::async, [picture = screen.read_back(), folder, recent = std::move(recent)] {
        try {
            write(picture, folder, recent);
        } catch (const Error&) {  // the start page shows the project without a picture
        }
    });
}

}  // namespace shvr::ui
