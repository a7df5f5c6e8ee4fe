#pragma once
// Draws a picture and writes it to a file at the same time: a worker thread encodes rows while the next band is drawn,
// so memory holds only two bands, however large the picture is. The file appears once it is complete; if drawing fails
// or is abandoned, an existing file stays unchanged. One thread, the renderer's.

#include <filesystem>
#include <functional>
#include <future>
#include <memory>

#include "engine/base/image_file.h"
#include "engine/picture/picture_job.h"

namespace shvr {

class PictureFile {
public:
    /// `path`: .png, or .pfm for linear light. `texts`: stored in a .png file. `over`: a function that draws over the
    /// picture's rows from `first_row` on; the worker thread calls it. Fails if the file cannot be written.
    using Over = std::function<void(ImageF& rows, uint32_t first_row)>;
    PictureFile(const std::filesystem::path& path, Renderer& renderer, const Session& session, const Camera& camera,
                const RenderOptions& options, const PictureTexts& texts = {}, Over over = {});

    bool is_drawn() const { return job_.is_done(); }
    /// Returns whether the worker is busy, in which case commit() or a step that completes a band would wait for it.
    bool is_writing() const;
    /// Like PictureJob::step; also fails if rows cannot be written.
    void step(bool waits = true) { job_.step(waits); }
    bool is_waiting() const { return job_.is_waiting(); }
    double progress() const { return job_.progress(); }
    bool is_complete() const { return job_.is_complete(); }
    /// Returns the picture without its image. Call it after the last step.
    Picture take() { return job_.take(); }
    /// Call this once everything is drawn: the worker thread writes the rest and renames the file to its final name.
    void begin_commit();
    bool is_committing() const { return is_committing_; }
    /// Waits for the commit, after starting it if necessary. Fails if the file cannot be written.
    void commit();

private:
    void write(ImageF rows);

    std::unique_ptr<ImageWriter> writer_;
    Over over_;
    uint32_t rows_ = 0;  ///< rows passed to the worker
    bool is_committing_ = false;
    std::future<void> written_;  ///< Result of the worker's last task; destroying it waits for the task.
    PictureJob job_;
};

}  // namespace shvr
