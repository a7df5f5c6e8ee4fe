#pragma once
// shvr render under mpirun: one picture in strips of rows, drawn by all ranks (engine/ranks).

#include "engine/picture/picture_file.h"
#include "engine/ranks/ranks.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

/// What `render_with_ranks` draws.
struct RanksPicture {
    const Camera& camera;
    const RenderOptions& how;
    const PictureTexts& texts;
    const PictureFile::Over& over;  ///< called on rank 0
    const std::string& input;
    const std::string& output;
};

struct RanksResult {
    Picture picture;             ///< without its image; its passes and warnings are those of all ranks
    bool is_whole = true;        ///< no rank met unreadable voxels
    Json ranks = Json::array();  ///< an object for each rank: its rows, counters and memory
    Json split = Json::object();
};

/// Draws strips until there are no more. On rank 0, also hands them out and writes the picture; the other ranks return
/// null.
std::optional<RanksResult> render_with_ranks(Ranks& ranks, Opened& opened, const RanksPicture& wanted,
                                             const Common& common, LongWork& work);

}  // namespace shvr::cli
