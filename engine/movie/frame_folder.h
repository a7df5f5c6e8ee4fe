#pragma once
// The folder that receives the frames of a movie as PNG files.

#include <filesystem>
#include <string>

namespace shvr {

/// Fails if the folder cannot be written, or holds anything but frames 1 to `frames` of an earlier movie, which are
/// replaced. It may be missing.
void check_frame_folder(const std::filesystem::path& folder, int frames);

/// Makes the folder if it is missing, and then removes it at the end if it is still empty.
class FrameFolder {
public:
    explicit FrameFolder(std::filesystem::path path);
    ~FrameFolder();
    FrameFolder(const FrameFolder&) = delete;

private:
    std::filesystem::path path_;
    bool is_new_;
};

/// Returns a clause that names the finished frames: "frames/frame-0001.png to frame-0012.png are finished".
std::string finished_frames(const std::filesystem::path& folder, int finished, int frames);

}  // namespace shvr
