#include "engine/movie/movie.h"

#include <algorithm>
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/movie/camera_path.h"
#include "engine/movie/look_between.h"

namespace shvr {

namespace {

constexpr const char *FRAME_PREFIX = "frame-", *FRAME_SUFFIX = ".png";
constexpr size_t MIN_DIGITS = 4;

}  // namespace

Movie::Movie(std::vector<MovieView> views, double turntable_degrees, int frames, const VolumeInfo& volume)
    : views_(std::move(views)), turntable_degrees_(turntable_degrees), frames_(frames), volume_(volume)
{
    SHVR_CHECK(!views_.empty() && frames > 0 && frames <= MAX_MOVIE_FRAMES, views_.size(), ' ', frames);
    if (views_.size() > size_t(frames))
        fail("a movie of ", counted(frames, "frame"), " cannot show ", counted(int64_t(views_.size()), "view"),
             "; expected at least one frame for each view");
    for (const MovieView& view : views_) {
        check_camera(view.camera);
        if (view.camera.projection != views_.front().camera.projection)
            fail("view ", in_quotes(view.name), " is ", spelled(view.camera.projection), ", and view ",
                 in_quotes(views_.front().name), " is ", spelled(views_.front().camera.projection),
                 "; expected the same projection in all views of a movie");
    }
    axis_ = turntable_axis(views_.front().camera);
}

int Movie::frame_of_view(size_t view) const
{
    const int64_t gaps = std::max<int64_t>(int64_t(views_.size()) - 1, 1);
    return int((2 * int64_t(view) * (frames_ - 1) + gaps) / (2 * gaps));
}

Movie::Frame Movie::frame(int index) const
{
    SHVR_CHECK(index >= 0 && index < frames_, index, " of ", frames_);
    size_t next = 0;
    while (next + 1 < views_.size() && frame_of_view(next) < index) ++next;
    Frame frame{views_[next].session, views_[next].camera};
    if (const int end = frame_of_view(next); next > 0 && index < end) {
        const MovieView &from = views_[next - 1], &to = views_[next];
        const int begin = frame_of_view(next - 1);
        const double share = eased(double(index - begin) / double(end - begin));
        frame = {session_between(from.session, to.session, share, volume_),
                 camera_between(from.camera, to.camera, share, volume_)};
    }
    frame.camera = turned(frame.camera, axis_, turntable_degrees_ * index / frames_);
    return frame;
}

std::string frame_file(int index, int frames)
{
    const size_t digits = std::max(MIN_DIGITS, std::to_string(frames).size());
    const std::string number = std::to_string(index + 1);
    return FRAME_PREFIX + std::string(digits - number.size(), '0') + number + FRAME_SUFFIX;
}

std::optional<int> number_of_frame_file(const std::string& name)
{
    const std::string_view prefix = FRAME_PREFIX, suffix = FRAME_SUFFIX;
    if (!name.starts_with(prefix) || !name.ends_with(suffix) || name.size() < prefix.size() + suffix.size()) return {};
    const std::string digits = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
    if (digits.size() < MIN_DIGITS || digits.size() > 6 || !std::ranges::all_of(digits, is_digit)) return {};
    return std::atoi(digits.c_str());
}

}  // namespace shvr
