#include "engine/picture/picture_file.h"

#include <chrono>
#include <utility>

namespace shvr {

PictureFile::PictureFile(const std::filesystem::path& path, Renderer& renderer, const Session& session,
                         const Camera& camera, const RenderOptions& options, const PictureTexts& texts, Over over)
    : writer_(image_writer(path, session.render.size.x, session.render.size.y, texts)),
      over_(std::move(over)),
      job_(renderer, session, camera, options, [this](ImageF rows) { write(std::move(rows)); })
{}

bool PictureFile::is_writing() const
{
    return written_.valid() && written_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

void PictureFile::write(ImageF rows)
{
    if (written_.valid()) written_.get();
    const uint32_t first_row = rows_;
    rows_ += uint32_t(rows.height);
    written_ = std::async(std::launch::async, [this, first_row, rows = std::move(rows)]() mutable {
        if (over_) over_(rows, first_row);
        writer_->add(rows);
    });
}

void PictureFile::begin_commit()
{
    SHVR_CHECK(is_drawn() && !is_committing_);
    is_committing_ = true;
    written_ = std::async(std::launch::async, [this, last_band = std::move(written_)]() mutable {
        if (last_band.valid()) last_band.get();
        writer_->commit();
    });
}

void PictureFile::commit()
{
    if (!is_committing_) begin_commit();
    written_.get();
}

}  // namespace shvr
