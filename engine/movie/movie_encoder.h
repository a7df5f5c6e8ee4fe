#pragma once
// Writes a movie file (.webm or .mp4) through the program ffmpeg. The file appears complete or not at all: ffmpeg
// writes to a file without a name, of which nothing is left even if this program is killed. One thread at a time.

#include <sys/types.h>

#include <filesystem>

#include <glm/glm.hpp>

#include "engine/base/file.h"
#include "engine/base/image.h"

namespace shvr {

/// Whether the name ends in .webm or .mp4.
bool is_movie_file(const std::filesystem::path& path);
/// Fails if ffmpeg is not installed, or if a side of the frames is odd, which neither format can store.
void check_movie_file(const std::filesystem::path& path, const glm::uvec2& size);

class MovieEncoder {
public:
    /// Starts ffmpeg.
    MovieEncoder(const std::filesystem::path& path, const glm::uvec2& size, double frames_per_second);
    ~MovieEncoder();
    MovieEncoder(const MovieEncoder&) = delete;
    MovieEncoder& operator=(const MovieEncoder&) = delete;

    /// Adds the next rows of a frame from the top, as wide as the frame and opaque. Fails if ffmpeg has ended.
    void add(const ImageF& rows);
    /// Waits for ffmpeg to complete the movie, then gives the file its name.
    void commit();

private:
    [[noreturn]] void refuse();

    std::filesystem::path path_;
    FileDescriptor movie_, complaints_;  ///< files without names, which ffmpeg writes
    int frames_ = -1;                    ///< socket from which ffmpeg reads; -1: closed
    pid_t process_ = -1;
};

}  // namespace shvr
