#include "engine/workbench/document/shots.h"

#include <chrono>
#include <utility>

#include "engine/base/text.h"
#include "engine/session/words/number_words.h"

namespace shvr::ui {

namespace {

bool is_busy(const std::future<void>& work)
{
    return work.valid() && work.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

PictureFile::Over drawn_over(std::shared_ptr<const Figure> figure)
{
    return [figure = std::move(figure)](ImageF& rows, uint32_t first_row) { draw(*figure, rows, first_row); };
}

}  // namespace

PictureShot::PictureShot(const std::filesystem::path& path, Renderer& renderer, const Session& session,
                         const Camera& camera, const RenderOptions& options, const PictureTexts& texts, Figure figure,
                         Words words, Then then)
    : Shot(path),
      file_(std::make_unique<PictureFile>(path, renderer, session, camera, options, texts,
                                          drawn_over(std::make_shared<const Figure>(std::move(figure))))),
      words_(std::move(words)),
      then_(std::move(then))
{}

bool PictureShot::is_writing() const
{
    return file_ ? file_->is_writing() : is_busy(after_);
}

void PictureShot::step()
{
    if (!file_) {
        after_.get();
        is_done_ = true;
        return;
    }
    if (!file_->is_drawn()) return file_->step(false);
    if (!file_->is_committing()) return file_->begin_commit();
    file_->commit();
    file_.reset();
    is_done_ = !then_;
    if (then_) after_ = std::async(std::launch::async, [then = then_, path = path_] { then(path); });
}

std::string PictureShot::progress_in_words() const
{
    return sentence(capitalised(words_.name), ": ", int(100.0 * progress()), " %");
}

MovieShot::MovieShot(const std::filesystem::path& path, Movie movie, double frames_per_second, Renderer& renderer,
                     const RenderOptions& options, Calls calls, bool has_own_look)
    : Shot(path),
      movie_(std::move(movie)),
      renderer_(renderer),
      size_(movie_.views().front().session.render.size),
      options_(options),
      calls_(std::move(calls)),
      has_own_look_(has_own_look)
{
    if (is_movie_file(path)) {
        check_movie_file(path, size_);
        encoder_ = std::make_unique<MovieEncoder>(path, size_, frames_per_second);
    } else {
        check_frame_folder(path, movie_.frames());
        folder_.emplace(path);
    }
}

bool MovieShot::is_writing() const
{
    return is_busy(written_) || (file_ && file_->is_writing());
}

void MovieShot::begin_frame()
{
    const Movie::Frame frame = movie_.frame(index_);
    groups_ = frame.session.groups;
    figure_ = std::make_shared<const Figure>(calls_.figure_of(frame));
    if (!encoder_) {
        const std::filesystem::path path = path_ / frame_file(index_, movie_.frames());
        file_ = std::make_unique<PictureFile>(path, renderer_, frame.session, frame.camera, options_,
                                              calls_.texts_of(frame, path), drawn_over(figure_));
        return;
    }
    job_ = std::make_unique<PictureJob>(renderer_, frame.session, frame.camera, options_,
                                        [this, row = uint32_t(0)](ImageF rows) mutable {
                                            const uint32_t first_row = row;
                                            row += uint32_t(rows.height);
                                            encode(std::move(rows), first_row);
                                        });
}

void MovieShot::encode(ImageF rows, uint32_t first_row)
{
    if (written_.valid()) written_.get();
    written_ = std::async(std::launch::async, [this, figure = figure_, first_row, rows = std::move(rows)]() mutable {
        draw(*figure, rows, first_row);
        encoder_->add(rows);
    });
}

void MovieShot::end_frame()
{
    if (file_) {
        if (!file_->is_committing()) return file_->begin_commit();
        file_->commit();
    }
    is_complete_ = is_complete_ && (file_ ? file_->is_complete() : job_->is_complete());
    file_.reset();
    job_.reset();
    ++index_;
}

void MovieShot::step()
{
    if (index_ == movie_.frames()) {
        if (written_.valid()) written_.get();
        is_done_ = !encoder_ || is_committing_;
        if (!is_done_) written_ = std::async(std::launch::async, [encoder = encoder_.get()] { encoder->commit(); });
        is_committing_ = true;
        return;
    }
    if (!job_ && !file_) return begin_frame();
    if (file_ ? file_->is_drawn() : job_->is_done()) return end_frame();
    calls_.draw_with(groups_, [this] { file_ ? file_->step(false) : job_->step(false); });
}

double MovieShot::progress() const
{
    const double part = file_ ? file_->progress() : job_ ? job_->progress() : 0.0;
    return (index_ + part) / movie_.frames();
}

std::string MovieShot::progress_in_words() const
{
    return sentence("Movie: frame ", std::min(index_ + 1, movie_.frames()), " of ", movie_.frames());
}

std::string MovieShot::said() const
{
    const std::string frames = counted(movie_.frames(), "frame");
    return sentence("Movie: ", path_.string(), " (", frames, ", ", size_.x, " x ", size_.y, " pixels)",
                    is_complete_ ? "" : "; not all bricks could be drawn");
}

std::string MovieShot::kept() const
{
    return folder_ && index_ > 0 ? finished_frames(path_, index_, movie_.frames()) : std::string();
}

}  // namespace shvr::ui
