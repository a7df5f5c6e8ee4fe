#pragma once
// A picture that is drawn and written to a file at the same time: rows are encoded on a thread of their own while the
// next band is drawn, so that memory holds two bands of the picture, however large it is. The file appears when it is
// whole; a picture that fails, or is abandoned, leaves the old file as it was. One thread, the renderer's.

#include <filesystem>
#include <functional>
#include <future>
#include <memory>

#include "engine/base/image_file.h"
#include "engine/picture/picture_job.h"

namespace shvr {

class PictureFile {
public:
    /// `path`: .png, or .pfm for linear light. `texts`: kept in a .png file. Fails where it cannot be written.
    /// `over`: draws over rows of the picture from `first_row` on, on the other thread.
    using Over = std::function<void(ImageF& rows, uint32_t first_row)>;
    PictureFile(const std::filesystem::path& path, Renderer& renderer, const Session& session, const Camera& camera,
                const RenderOptions& options, const PictureTexts& texts = {}, Over over = {});

    bool is_drawn() const { return job_.is_done(); }
    /// The other thread is busy: a step that completes the next band would wait for it, and commit() would.
    bool is_writing() const;
    /// As PictureJob::step; fails where rows cannot be written.
    void step(bool waits = true) { job_.step(waits); }
    bool is_waiting() const { return job_.is_waiting(); }
    double progress() const { return job_.progress(); }
    bool is_complete() const { return job_.is_complete(); }
    /// All but the image. Call it once no step follows.
    Picture take() { return job_.take(); }
    /// Once all is drawn: writes what is left on the other thread, and shows the file under its name.
    void begin_commit();
    bool is_committing() const { return is_committing_; }
    /// Waits for that; begins it where it has not begun. Fails where the file cannot be written.
    void commit();

private:
    void write(ImageF rows);

    std::unique_ptr<ImageWriter> writer_;
    Over over_;
    uint32_t rows_ = 0;  ///< that were handed over
    bool is_committing_ = false;
    std::future<void> written_;  ///< what was handed to the other thread last; destroyed, it waits
    PictureJob job_;
};

}  // namespace shvr
