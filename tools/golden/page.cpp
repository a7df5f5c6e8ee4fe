// Writes the HTML page and the JUnit file of a run.

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>

#include <nlohmann/json.hpp>

#include "engine/base/flip.h"
#include "engine/pages/html.h"
#include "tools/golden/run.h"

namespace shvr::golden {

namespace {

using report::escaped;

constexpr const char* STYLE = R"(.passed{color:var(--good)}.failed,.missing,.broken{color:var(--bad)}
.informative{color:var(--perhaps)}
img,.pair{image-rendering:pixelated;width:320px;border:1px solid var(--line);background:
repeating-conic-gradient(#ddd 0 25%,#fff 0 50%) 0/16px 16px}
.pair{position:relative;display:inline-block}.pair img{border:0;display:block;width:100%}
.pair .over{position:absolute;left:0;top:0}.blink .over{visibility:hidden}input[type=range]{width:320px;display:block}
.pixel{font:12px monospace;height:1.3em}pre{overflow-x:auto})";

// A slider sets how much of the actual picture covers the expected one. The key b, or a check box, alternates both.
constexpr const char* SCRIPT = R"(<script>
for (const pair of document.querySelectorAll('.pair')) {
  const over = pair.querySelector('.over'), under = pair.querySelector('img'), figure = pair.parentNode;
  const slider = figure.querySelector('input'), pixel = figure.querySelector('.pixel');
  slider.oninput = () => { over.style.clipPath = 'inset(0 ' + (100 - slider.value) + '% 0 0)'; };
  const read = image => {
    const canvas = document.createElement('canvas');
    canvas.width = image.naturalWidth; canvas.height = image.naturalHeight;
    const context = canvas.getContext('2d'); context.drawImage(image, 0, 0); return context; };
  let a, b;
  pair.onmousemove = event => {
    a = a || read(under); b = b || read(over);
    const box = pair.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left) / box.width * under.naturalWidth);
    const y = Math.floor((event.clientY - box.top) / box.height * under.naturalHeight);
    const of = context => Array.from(context.getImageData(x, y, 1, 1).data).join(' ');
    pixel.textContent = x + ',' + y + ': expected ' + of(a) + ', actual ' + of(b); };
}
let timer = 0;
document.onkeydown = event => {
  if (event.key !== 'b') return;
  const all = document.querySelectorAll('.pair');
  if (timer) { clearInterval(timer); timer = 0; all.forEach(p => p.classList.remove('blink')); }
  else timer = setInterval(() => all.forEach(p => p.classList.toggle('blink')), 400); };
</script>
)";

/// Maps differences to black, violet, red, orange, yellow and white: lightness increases in even steps.
Image8 heat_map(const Image8& a, const Image8& b)
{
    constexpr std::array<std::array<double, 3>, 6> STOPS{
        {{0, 0, 4}, {80, 18, 123}, {182, 54, 121}, {251, 136, 97}, {252, 205, 144}, {252, 253, 191}}};
    const std::vector<double> flip = flip_map(a, b);
    Image8 map{.width = a.width, .height = a.height, .rgba = std::vector<uint8_t>(a.rgba.size(), 255)};
    for (size_t pixel = 0; pixel < flip.size(); ++pixel) {
        const double place = std::clamp(flip[pixel], 0.0, 1.0) * double(STOPS.size() - 1);
        const auto stop = std::min(size_t(place), STOPS.size() - 2);
        for (size_t channel = 0; channel < 3; ++channel)
            map.rgba[4 * pixel + channel] =
                uint8_t(std::lround(std::lerp(STOPS[stop][channel], STOPS[stop + 1][channel], place - double(stop))));
    }
    return map;
}

std::string figure_of(const Image8& image, std::string_view caption)
{
    return sentence("<figure><img alt=\"", caption, "\" src=\"", report::source_of(image), "\"><figcaption>", caption,
                    "</figcaption></figure>\n");
}

std::string figures_of(const Result& result)
{
    std::string markup;
    if (result.expected) markup += figure_of(*result.expected, "expected");
    if (result.actual) markup += figure_of(*result.actual, "actual");
    if (!result.difference) return markup;
    if (result.status == Status::passed) return markup;
    markup += figure_of(difference_picture(*result.actual, *result.expected), "difference, 16 times");
    markup += figure_of(heat_map(*result.actual, *result.expected), "FLIP, from 0 (black) to 1");
    markup += sentence("<figure><div class=\"pair\"><img alt=\"expected\" src=\"", report::source_of(*result.expected),
                       "\"><img class=\"over\" alt=\"actual\" src=\"", report::source_of(*result.actual),
                       "\"></div><input type=\"range\" min=\"0\" max=\"100\" value=\"100\" aria-label=\"share of the "
                       "actual picture\"><div class=\"pixel\"></div><figcaption>actual over expected; b "
                       "blinks</figcaption></figure>\n");
    return markup;
}

std::string metrics_of(const ImageDifference& difference)
{
    std::string rows;
    const auto row = [&](const char* name, double value) {
        rows += sentence("<tr><td>", name, "</td><td>", std::setprecision(4), value, "</td></tr>");
    };
    row("largest difference, levels of 255", difference.max_abs);
    row("RMSE, levels of 255", difference.rmse);
    row("RMSE of alpha, levels of 255", difference.alpha_rmse);
    if (difference.psnr_db) row("PSNR, dB", *difference.psnr_db);
    row("SSIM", difference.ssim);
    row("FLIP, mean", difference.flip_mean);
    row("FLIP, 99 % below", difference.flip_p99);
    row("mean error, share of 1", difference.mean_error);
    row("pixels off by more than 1, %", 100.0 * difference.fraction_over_1);
    row("pixels off by more than 4, %", 100.0 * difference.fraction_over_4);
    return "<table>" + rows + "</table>\n";
}

std::string section_of(const Result& result)
{
    const Golden& golden = result.golden;
    std::string markup = sentence("<h2 id=\"", escaped(golden.name), "\">", escaped(golden.name), ": <span class=\"",
                                  spelled(result.status), "\">", spelled(result.status), "</span></h2>\n<p>",
                                  escaped(golden.why), "</p>\n<p>Class ", spelled(golden.strictness));
    if (!golden.loosened.empty()) markup += ", loosened: " + escaped(golden.loosened);
    markup += "</p>\n";
    if (!result.reason.empty()) markup += "<p><b>" + escaped(result.reason) + "</b></p>\n";
    markup += figures_of(result);
    if (result.difference && result.status != Status::passed) markup += metrics_of(*result.difference);
    if (result.status != Status::passed) {
        if (result.maker)
            markup += sentence("<p>Drawn by ", escaped(result.maker->driver), " on ", escaped(result.maker->processor),
                               " (", escaped(result.maker->instructions), ")</p>\n");
        if (can_be_blessed(result.status))
            markup += sentence("<p>If it is meant, look at it and accept it: <code>", escaped(bless_command(golden)),
                               "</code></p>\n");
    }
    if (!result.side_car.empty())
        markup += "<details><summary>who blessed it</summary><pre>" + escaped(result.side_car) + "</pre></details>\n";
    return markup;
}

}  // namespace

std::string page_of(const std::vector<Result>& results)
{
    std::vector<const Result*> order;
    for (const Result& result : results) order.push_back(&result);
    const auto rank = [](const Result* result) {
        return is_failure(result->status) ? 0 : result->status == Status::informative ? 1 : 2;
    };
    std::ranges::stable_sort(order, {}, rank);
    const auto failed = std::ranges::count_if(results, [](const Result& r) { return is_failure(r.status); });
    std::string body = sentence("<h1>SHVR goldens: ", failed == 0 ? "all pass" : sentence(failed, " failed"), " of ",
                                results.size(), "</h1>\n<p>");
    for (const Result* result : order)
        body += sentence("<a class=\"", spelled(result->status), "\" href=\"#", escaped(result->golden.name), "\">",
                         escaped(result->golden.name), "</a> ");
    body += "</p>\n";
    for (const Result* result : order) body += section_of(*result);
    return report::page("SHVR goldens", STYLE, body + SCRIPT);
}

std::string junit_of(const std::vector<Result>& results)
{
    const auto failed = std::ranges::count_if(results, [](const Result& r) { return is_failure(r.status); });
    double seconds = 0.0;
    for (const Result& result : results) seconds += result.seconds;
    std::string xml = sentence("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"shvr golden\" tests=\"",
                               results.size(), "\" failures=\"", failed, "\" time=\"", seconds, "\">\n");
    for (const Result& result : results) {
        xml += sentence("  <testcase classname=\"golden\" name=\"", escaped(result.golden.name), "\" time=\"",
                        result.seconds, "\">");
        if (is_failure(result.status))
            xml += sentence("<failure type=\"", spelled(result.status), "\" message=\"", escaped(result.reason), "\">",
                            can_be_blessed(result.status) ? escaped(bless_command(result.golden)) : std::string(),
                            "</failure>");
        else if (result.status == Status::informative)
            xml += "<skipped message=\"" + escaped(result.reason) + "\"/>";
        xml += "</testcase>\n";
    }
    return xml + "</testsuite>\n";
}

}  // namespace shvr::golden
