#pragma once
// Pictures that are drawn part by part while nothing else needs the device: large screenshots, figures and movies.
// Compression and encoding run on threads of their own; all else on the main thread.

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "engine/movie/frame_folder.h"
#include "engine/movie/movie.h"
#include "engine/movie/movie_encoder.h"
#include "engine/picture/picture_file.h"
#include "engine/workbench/sight/figure.h"

namespace shvr::ui {

class Shot {
public:
    virtual ~Shot() = default;
    Shot(const Shot&) = delete;
    Shot& operator=(const Shot&) = delete;

    /// Whether a worker is busy, in which case step() would wait for it.
    virtual bool is_writing() const = 0;
    /// Whether bricks are awaited; others may draw meanwhile.
    virtual bool is_waiting() const = 0;
    /// Whether it shows other looks than the window, so that the scene's ambient occlusion follows it.
    virtual bool has_own_look() const { return false; }
    /// Draws the next part, or completes the file. Fails if it cannot be made.
    virtual void step() = 0;
    virtual double progress() const = 0;
    bool is_done() const { return is_done_; }
    const std::filesystem::path& path() const { return path_; }
    /// "large screenshot"
    virtual std::string name() const = 0;
    /// "drawing scan-view-1.png"
    virtual std::string what() const { return "drawing " + path_.lexically_normal().filename().string(); }
    /// "Large screenshot: 40 %"
    virtual std::string progress_in_words() const = 0;
    /// What is said once it is done.
    virtual std::string said() const = 0;
    /// What a cancelled shot leaves on the disk; empty: nothing.
    virtual std::string kept() const { return {}; }

protected:
    explicit Shot(std::filesystem::path path) : path_(std::move(path)) {}
    bool is_done_ = false;
    std::filesystem::path path_;
};

/// One picture in a file.
class PictureShot final : public Shot {
public:
    struct Words {
        std::string name;  ///< "large screenshot"
        std::string said;  ///< what is said once it is done
    };
    /// `then`: called by a worker with the path of the finished file; may be null.
    using Then = std::function<void(const std::filesystem::path&)>;
    PictureShot(const std::filesystem::path& path, Renderer& renderer, const Session& session, const Camera& camera,
                const RenderOptions& options, const PictureTexts& texts, Figure figure, Words words, Then then = {});

    bool is_writing() const override;
    bool is_waiting() const override { return file_ && file_->is_waiting(); }
    void step() override;
    double progress() const override { return file_ ? file_->progress() : 1.0; }
    std::string name() const override { return words_.name; }
    std::string what() const override { return then_ ? "copying the picture" : Shot::what(); }
    std::string progress_in_words() const override;
    std::string said() const override { return words_.said; }

private:
    std::unique_ptr<PictureFile> file_;
    Words words_;
    Then then_;
    std::future<void> after_;
};

/// The frames of a movie, in a file or in a folder.
class MovieShot final : public Shot {
public:
    struct Calls {
        /// What is drawn over a frame; called for each, in order.
        std::function<Figure(const Movie::Frame& frame)> figure_of;
        /// What is stored in the file of a frame.
        std::function<PictureTexts(const Movie::Frame& frame, const std::filesystem::path& path)> texts_of;
        /// Calls `draw` while the trace has the colours of these groups.
        std::function<void(const Groups& groups, const std::function<void()>& draw)> draw_with;
    };
    MovieShot(const std::filesystem::path& path, Movie movie, double frames_per_second, Renderer& renderer,
              const RenderOptions& options, Calls calls, bool has_own_look);

    bool is_writing() const override;
    bool is_waiting() const override { return job_ ? job_->is_waiting() : file_ && file_->is_waiting(); }
    bool has_own_look() const override { return has_own_look_; }
    void step() override;
    double progress() const override;
    std::string name() const override { return "movie"; }
    std::string progress_in_words() const override;
    std::string said() const override;
    std::string kept() const override;

private:
    void begin_frame();
    void end_frame();
    void encode(ImageF rows, uint32_t first_row);

    Movie movie_;
    Renderer& renderer_;
    glm::uvec2 size_;
    RenderOptions options_;
    Calls calls_;
    bool has_own_look_;
    Groups groups_;  ///< the present frame's
    int index_ = 0;  ///< frames that are finished
    bool is_complete_ = true, is_committing_ = false;
    std::optional<FrameFolder> folder_;
    std::unique_ptr<MovieEncoder> encoder_;  ///< null: frames go to a folder
    std::shared_ptr<const Figure> figure_;   ///< over the present frame
    std::future<void> written_;              ///< work of the encoder; destroyed before it
    std::unique_ptr<PictureJob> job_;        ///< the present frame, if there is an encoder
    std::unique_ptr<PictureFile> file_;      ///< the present frame, if there is none
};

}  // namespace shvr::ui
