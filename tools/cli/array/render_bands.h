#pragma once
// shvr render --task: a picture in horizontal bands, one for each task.

#include "engine/picture/picture_file.h"
#include "engine/pieces/picture_rows.h"
#include "tools/cli/array/split_job.h"

namespace shvr::cli {

struct BandOptions {
    RenderOptions how;
    PictureTexts texts;                 ///< to be stored in the picture
    PictureFile::Over over;             ///< draws over the rows; empty: nothing
    std::vector<std::string> warnings;  ///< what `over` leaves out
};
/// Draws the task's band and writes it as its piece. Fails like a whole picture if the band is incomplete.
void draw_band(const SplitJob& job, Opened& opened, const Camera& camera, const BandOptions& options,
               const Common& common, LongWork& work);
/// Writes the picture that the bands make together, and prints its size and whether it is complete.
void join_bands(const SplitJob& job, const std::filesystem::path& output, const Common& common);

}  // namespace shvr::cli
