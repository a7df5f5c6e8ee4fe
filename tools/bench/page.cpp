#include "tools/bench/page.h"

#include <algorithm>
#include <cmath>
#include <iomanip>

#include <nlohmann/json.hpp>

#include "engine/base/image_file.h"
#include "engine/base/image_metrics.h"
#include "engine/pages/html.h"
#include "tools/bench/insets.h"

namespace shvr::bench {

namespace {

using report::escaped;

constexpr const char* STYLE = R"(.front{font-weight:bold}.off{color:var(--faint)}
figure img{image-rendering:pixelated;width:220px;border:1px solid var(--line)}h3{margin:1em 0 .2em;font-size:1em})";

std::string number(double value)
{
    return sentence(std::setprecision(3), value);
}

std::string percent(double share)
{
    return sentence(std::setprecision(3), 100.0 * share, " %");
}

std::string table_of(const SceneResult& scene)
{
    std::string rows = "<tr><th>run (bold: on the front)</th>";
    for (const char* head : {"median ms", "95 % of it", "min", "p95", "RMSE", "largest error", "PSNR dB", "SSIM",
                             "FLIP", "FLIP, 99 %", "off by &gt; 1 level", "&gt; 4", "samples"})
        rows += sentence("<th>", head, "</th>");
    rows += "</tr>\n";
    for (const Measured& run : scene.runs) {
        const auto samples = std::ranges::find(run.work, "samples", &std::pair<std::string, uint64_t>::first);
        const Error& error = run.error;
        rows += sentence("<tr class=\"", run.on_front ? "front" : "off", "\"><td>", escaped(run.name), "</td>");
        for (const std::string& text :
             {number(run.time.median_ms), number(run.time.low_ms) + " to " + number(run.time.high_ms),
              number(run.time.min_ms), number(run.time.p95_ms), number(error.rmse), number(error.max_abs),
              error.psnr_db ? number(*error.psnr_db) : std::string("equal"), sentence(std::setprecision(5), error.ssim),
              number(error.flip_mean), number(error.flip_p99), percent(error.fraction_over_1),
              percent(error.fraction_over_4), samples == run.work.end() ? std::string("-") : sentence(samples->second)})
            rows += "<td>" + text + "</td>";
        rows += "</tr>\n";
    }
    return "<h3>All runs</h3>\n<table>" + rows + "</table>\n";
}

std::string table_of_csv(const std::string& csv, const std::string& scene)
{
    std::string rows, text = csv;
    bool is_head = true;
    for (size_t end = 0; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
        std::string line = text.substr(0, end);
        if (!is_head && !scene.empty() && !line.starts_with("\"" + scene + "\"")) continue;
        std::string row;
        for (size_t comma = 0; comma != std::string::npos; line.erase(0, comma == std::string::npos ? 0 : comma + 1)) {
            comma = line.find(',');
            std::string cell = line.substr(0, comma);
            std::erase(cell, '"');
            if (!cell.empty() && cell.find_first_not_of("0123456789.e-+") == std::string::npos)
                cell = number(std::stod(cell));
            row += (is_head ? "<th>" : "<td>") + escaped(cell) + (is_head ? "</th>" : "</td>");
        }
        rows += "<tr>" + row + "</tr>\n";
        is_head = false;
    }
    return "<table>" + rows + "</table>\n";
}

std::string figure_of(const Image8& image, const std::string& caption)
{
    return sentence("<figure><img alt=\"", escaped(caption), "\" src=\"", report::source_of(image), "\"><figcaption>",
                    escaped(caption), "</figcaption></figure>\n");
}

std::string cell_of(const Measured* run)
{
    return run ? sentence("<td>", escaped(run->name), "</td><td>", number(run->time.median_ms), "</td><td>",
                          number(run->error.rmse), "</td>")
               : "<td>none</td><td>-</td><td>-</td>";
}

/// Returns a table of the time that SHVR needs for the comparison program's error, relative to that program's time.
std::string peer_table_of(const Results& results, const std::string& scene)
{
    std::string rows;
    for (const AtPeersError& row : at_peers_errors(results)) {
        if (row.scene != scene) continue;
        const auto ratio = [&](const Measured* run) {
            const double peer_ms = row.peer->time.median_ms;
            return run && peer_ms > 0.0 ? number(run->time.median_ms / peer_ms) : std::string("-");
        };
        rows += "<tr>" + cell_of(row.peer) + cell_of(row.fastest) + "<td><b>" + ratio(row.fastest) + "</b></td>" +
                cell_of(row.same_step) + "<td>" + ratio(row.same_step) + "</td></tr>\n";
    }
    if (rows.empty()) return {};
    return "<h3>Time at equal error</h3>\n<p>SHVR's fastest run whose error is no larger than VTK's, and its run of "
           "the same "
           "step.</p>\n<table><tr><th>VTK</th><th>ms</th><th>RMSE</th><th>SHVR</th><th>ms</th><th>RMSE</th><th>time "
           "over VTK's</th><th>same step</th><th>ms</th><th>RMSE</th><th>time over VTK's</th></tr>\n" +
           rows + "</table>\n";
}

std::string sentences_of(const std::vector<std::string>& notes)
{
    std::string markup;
    for (const std::string& note : notes) markup += "<p>" + escaped(note) + "</p>\n";
    return markup;
}

std::string section_of(const Sweep& sweep)
{
    return sentence("<h2>", escaped(sweep.name), "</h2>\n<p>", escaped(sweep.what), "</p>\n",
                    sweep.svg.empty() ? report::svg_of(sweep.plot) : sweep.svg,
                    "\n<details><summary>As a table</summary>", table_of_csv(csv_of(sweep), {}), "</details>\n");
}

std::string pictures_of(const Pictures& pictures)
{
    const Image8 truth = to_image8(pictures.reference);
    std::string markup = figure_of(truth, "reference renderer, in double precision");
    for (const auto& [name, picture] : pictures.of_qualities) {
        const Image8 seen = to_image8(picture);
        markup += figure_of(seen, name) + figure_of(difference_picture(seen, truth), name + ": difference, 16 times");
    }
    const Insets insets = insets_of(pictures);
    const Window& window = insets.window;
    markup += sentence("<p>Where <i>interactive</i> errs most, pixels ", window.x, ",", window.y, " to ",
                       window.x + window.width, ",", window.y + window.height, ":</p>\n");
    for (const auto& [name, picture] : insets.pictures)
        markup +=
            figure_of(enlarged(*picture, window, 1),
                      picture == &pictures.reference
                          ? name
                          : sentence(name, ": RMSE here ", number(rmse_in(*picture, pictures.reference, window))));
    return markup;
}

/// Returns whether a run gets a label: all qualities do, and the comparison program's run at the step of `interactive`.
bool is_labelled(const Measured& run)
{
    return run.family == "quality" || (is_peer(run.family) && run.name.ends_with("step 0.5"));
}

double error_by(const Measured& run, Metric metric)
{
    return metric == Metric::rmse ? run.error.rmse : run.error.flip_mean;
}

}  // namespace

report::Plot plot_of(const SceneResult& scene, Metric metric)
{
    report::Plot plot{.title = scene.name + " (" + scene.volume + ")",
                      .x_label = "median time of a picture, ms",
                      .y_label = metric == Metric::rmse ? "RMSE in linear light" : "visible difference (mean FLIP)",
                      .series = {}};
    for (const char* family : families()) {
        report::PlotSeries series{family, {}, false, is_peer(family)};
        for (const Measured& run : scene.runs)
            if (run.family == family)
                series.points.push_back({run.time.median_ms, error_by(run, metric),
                                         is_labelled(run) ? run.name : std::string(), run.on_front});
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    return plot;
}

report::Plot plot_of_qualities(const Results& results)
{
    // The x axis counts samples read, which are equal on every machine, so that the plot can be committed and compared.
    report::Plot plot{.title = "draft, interactive, good, reference: from left to right",
                      .x_label = "texels read for a picture",
                      .y_label = "RMSE in linear light",
                      .series = {}};
    for (const SceneResult& scene : results.scenes) {
        report::PlotSeries series{scene.name, {}, true, false};
        for (const Measured& run : scene.runs) {
            const auto reads = std::ranges::find(run.work, "density_reads", &std::pair<std::string, uint64_t>::first);
            if (run.family == "quality" && reads != run.work.end())
                series.points.push_back({double(reads->second), run.error.rmse, {}, false});
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

std::string page_of(const Results& results, const std::vector<Pictures>& pictures, const std::vector<Sweep>& sweeps)
{
    std::string body = sentence("<h1>Speed against error</h1>\n<p>SHVR ", escaped(results.version),
                                results.commit.empty() ? "" : ", commit " + escaped(results.commit.substr(0, 12)), "; ",
                                escaped(results.driver), ", ", escaped(results.processor), ", ", results.cores,
                                " cores, load ", number(results.load), " at the start. Pictures of ", results.width,
                                " x ", results.height, " pixels; medians of ", results.rounds,
                                " rounds in turns. Errors are against the double-precision reference renderer, which "
                                "shares no code with what it measures.</p>\n");
    body += sentences_of(results.left_out);
    if (!results.scenes.empty()) body += report::svg_of(plot_of_qualities(results));
    const std::string equal_errors = equal_error_csv(results), equal_times = equal_time_csv(results);
    for (size_t i = 0; i < results.scenes.size(); ++i) {
        const SceneResult& scene = results.scenes[i];
        body += sentence("<h2>", escaped(scene.name), "</h2>\n<p>", escaped(scene.what), "; ", escaped(scene.volume),
                         "</p>\n", report::svg_of(plot_of(scene, Metric::rmse)),
                         report::svg_of(plot_of(scene, Metric::flip)));
        if (i < pictures.size()) body += "<div>" + pictures_of(pictures[i]) + "</div>\n";
        if (const std::optional<std::string> busy = why_times_tell_little(scene))
            body += "<p><b>" + escaped(*busy) + "</b></p>\n";
        body += sentences_of(scene.notes) + peer_table_of(results, scene.name) + table_of(scene);
        body += "<details><summary>Equal error: the fastest of each knob</summary>" +
                table_of_csv(equal_errors, scene.name) + "</details>\n";
        body += "<details><summary>Equal time: the most exact of each knob</summary>" +
                table_of_csv(equal_times, scene.name) + "</details>\n";
    }
    for (const Sweep& sweep : sweeps) body += section_of(sweep);
    return report::page("SHVR: speed against error", STYLE, body);
}

std::vector<std::string> write_files(const Results& results, const std::vector<Pictures>& pictures,
                                     const std::vector<Sweep>& sweeps, const std::filesystem::path& output)
{
    std::vector<std::string> written;
    const auto write = [&](const std::string& name, const std::string& text) {
        report::write_text(output / name, text);
        written.push_back((output / name).string());
    };
    const auto write_plot = [&](const std::string& name, const report::Plot& plot) {
        write(name + ".svg", report::svg_of(plot));
        write_png(output / (name + ".png"), report::picture_of(plot));
        written.push_back((output / (name + ".png")).string());
    };
    write("bench.json", json_of(results).dump(1) + "\n");
    write("bench.csv", csv_of(results));
    write("equal_error.csv", equal_error_csv(results));
    write("equal_time.csv", equal_time_csv(results));
    write("equal_peer.csv", equal_peer_csv(results));
    write("front.csv", front_csv(results));
    write_plot("pareto", plot_of_qualities(results));
    if (!pictures.empty()) {
        write_png(output / "insets.png", sheet_of(results, pictures));
        written.push_back((output / "insets.png").string());
    }
    for (const SceneResult& scene : results.scenes) write_plot("pareto-" + scene.name, plot_of(scene, Metric::rmse));
    for (const Sweep& sweep : sweeps) {
        write(sentence("sweep-", sweep.name, ".csv"), csv_of(sweep));
        write(sentence("sweep-", sweep.name, ".svg"), sweep.svg.empty() ? report::svg_of(sweep.plot) : sweep.svg);
    }
    write("report.html", page_of(results, pictures, sweeps));
    return written;
}

std::string text_of(const Comparison& comparison)
{
    std::string text;
    for (const std::string& sentence : comparison.beside) text += sentence + "\n";
    for (const Change& change : comparison.changes) {
        text += sentence(change.is_regression ? "worse   " : "changed ", change.scene, ", ", change.run, ": ",
                         change.what, " ", std::setprecision(6), change.a, " -> ", change.b);
        if (change.noise > 0.0) text += sentence(" (noise ", std::setprecision(3), change.noise, ")");
        if (change.machine != 1.0)
            text += sentence(", where the machine took ", std::setprecision(3), change.machine, " times as long");
        text += "\n";
    }
    return comparison.changes.empty() ? text + "nothing changed\n" : text;
}

}  // namespace shvr::bench
