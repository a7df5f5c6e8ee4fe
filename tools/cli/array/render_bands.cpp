#include "tools/cli/array/render_bands.h"

#include <algorithm>

#include "engine/base/text.h"

namespace shvr::cli {

namespace {

/// Reads the descriptions of all bands, and fails unless they make one picture.
std::vector<PictureRows> bands_of(const SplitJob& job)
{
    std::vector<PictureRows> bands;
    int64_t next = 0;
    for (int64_t task = 0; task < job.of(); ++task) {
        bands.push_back(read_rows_description(job.piece(task)));
        const PictureRows &first = bands.front(), &band = bands.back();
        if (band.width != first.width || band.height != first.height || band.lower != next)
            fail(job.piece(task).string(), ": holds rows ", band.lower, " to ", band.upper, " of a picture of ",
                 band.width, " x ", band.height, "; expected rows from ", next, " of ", first.width, " x ",
                 first.height, ": remove the piece, and run its task again");
        next = band.upper;
    }
    if (next != bands.front().height)
        fail(job.folder().string(), ": holds ", next, " rows; expected ", bands.front().height,
             ": remove the last piece, and run its task again");
    return bands;
}

}  // namespace

void draw_band(const SplitJob& job, Opened& opened, const Camera& camera, const BandOptions& options,
               const Common& common, LongWork& work)
{
    const glm::uvec2 size = opened.session.render.size;
    const TaskChoice::Range range = job.choice().range_of(size.y);
    PictureRowsWriter writer(job.piece());
    auto next = uint32_t(range.lower);
    const auto take = [&](ImageF rows) {
        if (options.over) options.over(rows, next);
        next += uint32_t(rows.height);
        writer.add(rows);
    };
    PictureJob band(*opened.renderer, opened.session, camera, options.how, take,
                    {.lower = uint32_t(range.lower), .upper = uint32_t(range.upper)});
    while (!band.is_done() && (band.is_complete() || *common.allows_incomplete)) {
        work.stop_if_asked();
        band.step();
    }
    Picture picture = band.take();
    if (!picture.complete && !*common.allows_incomplete)
        fail(job.piece().string(), ": the picture's rows are incomplete and not written: ",
             picture.warnings.empty() ? "not all bricks that rays visited could be drawn" : picture.warnings.front(),
             opened.gaps->has_refused() ? "" : "; --allow-incomplete writes them nevertheless");
    check_validation(opened);
    picture.warnings.insert(picture.warnings.end(), options.warnings.begin(), options.warnings.end());
    const gpu::DeviceTraits& traits = opened.renderer->device().traits();
    writer.commit({.width = size.x,
                   .height = size.y,
                   .lower = range.lower,
                   .upper = range.upper,
                   .device = traits.name + ", " + traits.driver,
                   .is_complete = picture.complete && opened.is_complete(),
                   .warnings = picture.warnings,
                   .texts = options.texts});
}

void join_bands(const SplitJob& job, const std::filesystem::path& output, const Common& common)
{
    LongWork work(common.quiet);
    const Progress progress = work.begin("joining " + output.string());
    const std::vector<PictureRows> bands = bands_of(job);
    const PictureRows& first = bands.front();
    const std::unique_ptr<ImageWriter> writer = image_writer(output, first.width, first.height, first.texts);
    std::vector<std::string> warnings;
    bool is_complete = true;
    for (int64_t task = 0; task < job.of(); ++task) {
        const PictureRows& band = bands[size_t(task)];
        tell(progress, double(task) / double(job.of()));
        read_rows(job.piece(task), band, [&](const ImageF& rows) { writer->add(rows); });
        is_complete = is_complete && band.is_complete;
        for (const std::string& warning : band.warnings)
            if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(warning);
        if (band.device != first.device)
            warnings.push_back(sentence(job.piece(task).string(), ": was drawn by ", band.device, ", and ",
                                        job.piece(0).string(), " by ", first.device, ", which may round differently"));
    }
    writer->commit();
    warn(warnings, common);
    print({{"output", output.string()},
           {"size", {first.width, first.height}},
           {"complete", is_complete},
           {"device", first.device},
           {"warnings", warnings}});
}

}  // namespace shvr::cli
