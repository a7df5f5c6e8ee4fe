#include "tools/cli/array/render_ranks.h"

#include <unistd.h>

#include <algorithm>

#include "engine/base/atomic_writer.h"
#include "engine/base/image_file.h"
#include "engine/base/text.h"
#include "engine/ranks/picture_desk.h"
#include "engine/ranks/picture_worker.h"
#include "tools/cli/array/ranks_job.h"

namespace shvr::cli {

namespace {

/// Height of the small picture in which work is counted, and its largest width.
constexpr uint32_t COUNTED_ROWS = 64, MAX_COUNTED_COLUMNS = 256;
/// Pictures with fewer rows are divided by rows alone: counting would cost more than an uneven division.
constexpr uint32_t MIN_ROWS_TO_COUNT = 4 * COUNTED_ROWS;
constexpr uint64_t PIXEL_BYTES = 4 * sizeof(float);

uint64_t counted(const std::vector<gpu::PassReport>& passes)
{
    uint64_t sum = 0;
    for (const gpu::PassReport& pass : passes)
        if (!pass.counters.empty()) sum += pass.counters[gpu::COUNTER_SAMPLES] + pass.counters[gpu::COUNTER_RAYS];
    return sum;
}

/// Rays and samples of each row of a small picture. Empty, which stands for rows of equal work, if counting would cost
/// too much: without coarser levels, a small picture reads as many bricks as a large one.
std::vector<double> work_of_rows(Opened& opened, const RanksPicture& wanted)
{
    Session small = opened.session;
    const glm::uvec2 size = small.render.size;
    const bool is_paged = opened.renderer->volume().counts().has_value();
    if (size.y < MIN_ROWS_TO_COUNT || (is_paged && opened.renderer->scene().draws_finest())) return {};
    small.render.size = {
        std::clamp<uint32_t>(uint32_t(uint64_t(size.x) * COUNTED_ROWS / size.y), 1, MAX_COUNTED_COLUMNS), COUNTED_ROWS};
    small.render.detail = std::max(small.render.detail, 1.0);
    small.light.occlusion.strength = 0.0;
    RenderOptions how = wanted.how;
    how.count_work = true;
    how.progress = {};
    std::vector<double> work;
    for (uint32_t row = 0; row < COUNTED_ROWS; ++row) {
        PictureJob job(*opened.renderer, small, wanted.camera, how, [](const ImageF&) {},
                       {.lower = row, .upper = row + 1});
        while (!job.is_done()) job.step();
        work.push_back(double(counted(job.take().passes)));
    }
    return work;
}

/// Adds times and counters of passes to those of the same names.
void append_passes(std::vector<gpu::PassReport>& sum, std::vector<gpu::PassReport> passes)
{
    for (gpu::PassReport& pass : passes) {
        const auto known = std::ranges::find(sum, pass.name, &gpu::PassReport::name);
        if (known == sum.end()) {
            sum.push_back(std::move(pass));
            continue;
        }
        known->gpu_ms += pass.gpu_ms;
        known->timed = known->timed && pass.timed;
        known->counters.resize(std::max(known->counters.size(), pass.counters.size()));
        for (size_t i = 0; i < pass.counters.size(); ++i) known->counters[i] += pass.counters[i];
    }
}

/// What a rank has drawn so far.
struct Drawn {
    Picture picture;
    int64_t rows = 0, strips = 0;
};

/// Adds what a strip has cost to what the strips before it have cost.
void add(Drawn& drawn, Picture strip)
{
    drawn.picture.complete = drawn.picture.complete && strip.complete;
    for (std::string& warning : strip.warnings)
        if (std::ranges::find(drawn.picture.warnings, warning) == drawn.picture.warnings.end())
            drawn.picture.warnings.push_back(std::move(warning));
    append_passes(drawn.picture.passes, std::move(strip.passes));
}

/// Draws a strip and sends its rows. Returns early if the picture will not be made.
void draw_strip(PictureWorker& worker, Opened& opened, const RanksPicture& wanted, const Common& common,
                const LongWork& work, const RowStrip& strip, Drawn& drawn)
{
    int64_t next_row = strip.lower;
    const auto send = [&](ImageF rows) {
        const int64_t count = rows.height;
        worker.send(next_row, std::move(rows));
        next_row += count;
    };
    RenderOptions how = wanted.how;
    how.progress = {};
    PictureJob job(*opened.renderer, opened.session, wanted.camera, how, send,
                   {.lower = uint32_t(strip.lower), .upper = uint32_t(strip.upper)});
    while (!job.is_done() && (job.is_complete() || *common.allows_incomplete)) {
        work.stop_if_asked();
        if (worker.is_ended()) return;
        job.step();
    }
    Picture picture = job.take();
    if (!picture.complete && !*common.allows_incomplete)
        fail(wanted.input, ": the picture is incomplete and not written: ",
             picture.warnings.empty() ? "not all bricks that rays visited could be drawn" : picture.warnings.front(),
             opened.gaps->has_refused() ? "" : "; --allow-incomplete writes it nevertheless");
    add(drawn, std::move(picture));
    drawn.rows += strip.upper - strip.lower;
    ++drawn.strips;
}

Json report_of(Opened& opened, const Drawn& drawn, int rank)
{
    const gpu::DeviceTraits& traits = opened.renderer->device().traits();
    char host[256] = {};
    static_cast<void>(::gethostname(host, sizeof host - 1));
    Json passes = Json::array();
    for (const gpu::PassReport& pass : drawn.picture.passes)
        passes.push_back(
            {{"name", pass.name}, {"timed", pass.timed}, {"gpu_ms", pass.gpu_ms}, {"counters", pass.counters}});
    std::vector<std::string> warnings = drawn.picture.warnings;
    if (!opened.is_whole()) warnings.push_back(opened.gaps->in_words());
    return {{"rank", rank},
            {"host", host},
            {"device", traits.name + ", " + traits.driver},
            {"rows", drawn.rows},
            {"strips", drawn.strips},
            {"complete", drawn.picture.complete && !opened.lacks_meshes},
            {"voxels_not_read", opened.voxels_not_read()},
            {"passes", passes},
            {"counters", counters_of(drawn.picture.passes)},
            {"bricks", bricks_of(*opened.renderer)},
            {"bytes", bytes_of(*opened.renderer)},
            {"warnings", warnings}};
}

/// Draws strips until there are no more, and reports to the desk.
void work_for_desk(PictureWorker& worker, Ranks& ranks, Opened& opened, const RanksPicture& wanted,
                   const Common& common, const LongWork& work, const std::function<void()>& between)
{
    Drawn drawn;
    while (const std::optional<RowStrip> strip = worker.next()) {
        draw_strip(worker, opened, wanted, common, work, *strip, drawn);
        if (between) between();
    }
    check_validation(opened);
    worker.end_done(report_of(opened, drawn, ranks.index()).dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Joins the reports of all ranks.
RanksResult joined(const std::vector<std::string>& reports)
{
    RanksResult result;
    for (const std::string& text : reports) {
        Json report = Json::parse(text);
        result.picture.complete = result.picture.complete && report["complete"].get<bool>();
        result.is_whole = result.is_whole && report["voxels_not_read"].get<int64_t>() == 0;
        std::vector<gpu::PassReport> passes;
        for (const Json& pass : report["passes"]) {
            gpu::PassReport& each = passes.emplace_back();
            each.name = pass["name"].get<std::string>();
            each.timed = pass["timed"].get<bool>();
            each.gpu_ms = pass["gpu_ms"].get<double>();
            each.counters = pass["counters"].get<std::vector<uint64_t>>();
        }
        append_passes(result.picture.passes, std::move(passes));
        for (const Json& warning : report["warnings"])
            if (std::ranges::find(result.picture.warnings, warning.get<std::string>()) == result.picture.warnings.end())
                result.picture.warnings.push_back(warning.get<std::string>());
        report.erase("passes");
        report.erase("warnings");
        result.ranks.push_back(std::move(report));
    }
    const Json& first = result.ranks.front();
    for (const Json& rank : result.ranks)
        if (rank["device"] != first["device"])
            result.picture.warnings.push_back(
                sentence("rank ", rank["rank"].get<int>(), " drew with ", rank["device"].get<std::string>(),
                         ", and rank 0 with ", first["device"].get<std::string>(), ", which may round differently"));
    return result;
}

/// How far strips may reach beyond the rows that are written: what waits on rank 0 takes a quarter of its memory.
struct Window {
    int64_t rows = 0, rows_at_once = 0;  ///< the second: of a round of strips
};
Window window_of(Opened& opened)
{
    const glm::uvec2 size = opened.session.render.size;
    const uint64_t row_bytes = PIXEL_BYTES * size.x;
    const auto rows = std::max<int64_t>(int64_t(opened.renderer->memory().host_bytes_left() / 4 / row_bytes), 1);
    // Two rounds fit, so that ranks go on while others end a round.
    return {rows, rows >= size.y ? size.y : std::max<int64_t>(rows / 2, 1)};
}

}  // namespace

std::optional<RanksResult> render_with_ranks(Ranks& ranks, Opened& opened, const RanksPicture& wanted,
                                             const Common& common, LongWork& work)
{
    PictureWorker worker(ranks);
    if (ranks.index() > 0) {
        work_for_desk(worker, ranks, opened, wanted, common, work, {});
        return std::nullopt;
    }
    const glm::uvec2 size = opened.session.render.size;
    collect_temporary_files(std::filesystem::path(wanted.output).parent_path());  // of a rank 0 that was killed
    const std::unique_ptr<ImageWriter> writer = image_writer(wanted.output, size.x, size.y, wanted.texts);
    const std::vector<double> counts = work_of_rows(opened, wanted);
    const Window window = window_of(opened);
    std::vector<std::string> reports;
    int64_t peak_rows = 0;
    {
        PictureDesk desk(ranks, {size.y, counts, ranks.count(), window.rows_at_once}, {size.x, size.y, window.rows},
                         [&, first_row = uint32_t(0)](ImageF rows) mutable {
                             if (wanted.over) wanted.over(rows, first_row);
                             first_row += uint32_t(rows.height);
                             writer->add(rows);
                         });
        try {
            work_for_desk(worker, ranks, opened, wanted, common, work,
                          [&] { tell(wanted.how.progress, desk.progress()); });
        } catch (const std::exception& error) {
            worker.end_failed(error.what());
            note_ranks_have_ended();
            throw;
        }
        note_ranks_have_ended();
        reports = desk.finish();
        peak_rows = desk.peak_waiting_rows();
    }
    RanksResult result = joined(reports);
    result.split = {{"counted_work", counts}, {"rows_at_once", window.rows_at_once}, {"peak_rows_waiting", peak_rows}};
    writer->commit();
    return result;
}

}  // namespace shvr::cli
