#pragma once
// A movie as a list of frames: key views, the way between them, and a turntable. Pure; any thread.

#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

/// A view that a movie shows. Sessions of a movie's views differ at most in what session_between() mixes.
struct MovieView {
    std::string name;  ///< for messages
    Session session;
    Camera camera;
};

inline constexpr int MAX_MOVIE_FRAMES = 100'000;

class Movie {
public:
    struct Frame {
        Session session;
        Camera camera;
    };
    /// `turntable_degrees` is spread over all frames: frame i is turned by i / frames of it, so that the movie of a
    /// whole turn can run in a loop. Fails if there are more views than frames, if views are of different projections,
    /// or if a camera is degenerate. There is at least one view.
    Movie(std::vector<MovieView> views, double turntable_degrees, int frames, const VolumeInfo& volume);

    int frames() const { return frames_; }
    /// View k of K appears at the frame closest to k / (K - 1) of the movie. Between two views the movie eases: it
    /// leaves one and reaches the other without speed (camera_between, session_between). Without a turntable, the frame
    /// of a view is exactly that view. One view lasts for the whole movie.
    Frame frame(int index) const;
    /// Returns the number of the frame at which view `view` appears; frames count from 0.
    int frame_of_view(size_t view) const;
    const std::vector<MovieView>& views() const { return views_; }

private:
    std::vector<MovieView> views_;
    double turntable_degrees_;
    int frames_;
    VolumeInfo volume_;
    glm::dvec3 axis_;  ///< axis of the turntable
};

/// Returns "frame-0007.png" for index 6 of a movie of at most 9999 frames. Numbers count from 1.
std::string frame_file(int index, int frames);
/// Returns the number in the name of a frame's file; null if it is not named by frame_file().
std::optional<int> number_of_frame_file(const std::string& name);

}  // namespace shvr
