#include "tools/report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <limits>
#include <memory>

#include "engine/base/error.h"
#include "engine/pages/html.h"
#include "tools/report/glyphs.h"

namespace shvr::report {

namespace {

struct Color {
    uint8_t r, g, b;
};
constexpr Color INK{40, 40, 40}, GRID{222, 222, 222};
constexpr std::array<Color, 7> COLORS{
    {{0, 114, 178}, {230, 159, 0}, {0, 158, 115}, {213, 94, 0}, {204, 121, 167}, {86, 180, 233}, {120, 110, 20}}};
constexpr int MARKS = 4;  // disc, square, diamond, triangle

/// Interface for drawing a plot, implemented for SVG and pixels. The y axis points down.
class Canvas {
public:
    virtual ~Canvas() = default;
    virtual void line(double x0, double y0, double x1, double y1, double width, Color color) = 0;
    virtual void mark(double x, double y, int kind, double radius, Color color, double opacity) = 0;
    /// `anchor`: x is the begin (0), middle (1) or end (2) of the text; y is the base line. `upright`: runs upwards.
    virtual void text(double x, double y, const std::string& text, int anchor, bool upright = false) = 0;
};

class SvgCanvas final : public Canvas {
public:
    void line(double x0, double y0, double x1, double y1, double width, Color color) override
    {
        markup += sentence("<line x1=\"", x0, "\" y1=\"", y0, "\" x2=\"", x1, "\" y2=\"", y1, "\" stroke=\"",
                           rgb(color), "\" stroke-width=\"", width, "\"/>\n");
    }
    void mark(double x, double y, int kind, double r, Color color, double opacity) override
    {
        const std::string look = sentence(" fill=\"", rgb(color), "\" fill-opacity=\"", opacity, "\"/>\n");
        if (kind == 0)
            markup += sentence("<circle cx=\"", x, "\" cy=\"", y, "\" r=\"", r, "\"", look);
        else if (kind == 1)
            markup += sentence("<rect x=\"", x - r, "\" y=\"", y - r, "\" width=\"", 2 * r, "\" height=\"", 2 * r, "\"",
                               look);
        else if (kind == 2)
            markup += sentence("<path d=\"M", x, " ", y - 1.3 * r, "L", x + 1.3 * r, " ", y, "L", x, " ", y + 1.3 * r,
                               "L", x - 1.3 * r, " ", y, "Z\"", look);
        else
            markup += sentence("<path d=\"M", x, " ", y - 1.3 * r, "L", x + 1.2 * r, " ", y + r, "L", x - 1.2 * r, " ",
                               y + r, "Z\"", look);
    }
    void text(double x, double y, const std::string& text, int anchor, bool upright) override
    {
        constexpr const char* ANCHORS[] = {"start", "middle", "end"};
        markup += sentence("<text x=\"", x, "\" y=\"", y, "\" text-anchor=\"", ANCHORS[anchor], "\"",
                           upright ? sentence(" transform=\"rotate(-90 ", x, " ", y, ")\"") : std::string(), ">",
                           escaped(text), "</text>\n");
    }
    std::string markup;

private:
    static std::string rgb(Color color)
    {
        return sentence("rgb(", int(color.r), ",", int(color.g), ",", int(color.b), ")");
    }
};

/// Draws at SCALE times the size and then averages, for smooth edges.
class PixelCanvas final : public Canvas {
public:
    PixelCanvas(int width, int height)
        : width_(width * SCALE), height_(height * SCALE), pixels_(size_t(width_) * size_t(height_) * 3, 255)
    {}

    void line(double x0, double y0, double x1, double y1, double width, Color color) override
    {
        const double length = std::hypot(x1 - x0, y1 - y0) * SCALE, r = std::max(0.5 * width * SCALE, 0.5);
        for (int i = 0; i <= int(length); ++i) {
            const double share = length > 0.0 ? i / length : 0.0;
            fill(
                std::lerp(x0, x1, share) * SCALE, std::lerp(y0, y1, share) * SCALE, r,
                [](double, double) { return true; }, color, 1.0);
        }
    }
    void mark(double x, double y, int kind, double radius, Color color, double opacity) override
    {
        const double r = radius * SCALE;
        const auto is_inside = [&](double dx, double dy) {
            if (kind == 0) return std::hypot(dx, dy) <= r;
            if (kind == 1) return std::abs(dx) <= r && std::abs(dy) <= r;
            if (kind == 2) return std::abs(dx) + std::abs(dy) <= 1.3 * r;
            return dy <= r && dy >= -1.3 * r && std::abs(dx) <= 1.2 * r * (dy + 1.3 * r) / (2.3 * r);
        };
        fill(x * SCALE, y * SCALE, 1.4 * r, is_inside, color, opacity);
    }
    void text(double x, double y, const std::string& text, int anchor, bool upright) override
    {
        const double wide = text_width(text) * (anchor == 2 ? 1.0 : anchor == 1 ? 0.5 : 0.0);
        for (size_t i = 0; i < text.size(); ++i)
            for (int column = 0; column < GLYPH_COLUMNS; ++column)
                for (int row = 0; row <= GLYPH_ROWS; ++row) {
                    if (!glyph_has(text[i], column, row)) continue;
                    const double along = double(i) * (GLYPH_COLUMNS + 1) + column - wide, up = GLYPH_ROWS - row;
                    // A letter is drawn with dots that are slightly wider than a pixel.
                    constexpr double TEXEL = 1.25;
                    const double px = upright ? x - TEXEL * up : x + TEXEL * along;
                    const double py = upright ? y - TEXEL * along : y - TEXEL * up;
                    square(px * SCALE, py * SCALE, int(std::ceil(TEXEL * SCALE)));
                }
    }
    Image8 image() const
    {
        Image8 image{width_ / SCALE, height_ / SCALE, {}};
        image.rgba.assign(size_t(image.width) * size_t(image.height) * 4, 255);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                for (size_t channel = 0; channel < 3; ++channel) {
                    int sum = 0;
                    for (int i = 0; i < SCALE * SCALE; ++i)
                        sum += pixels_[3 * (size_t(y * SCALE + i / SCALE) * size_t(width_) +
                                            size_t(x * SCALE + i % SCALE)) +
                                       channel];
                    image.rgba[4 * (size_t(y) * size_t(image.width) + size_t(x)) + channel] =
                        uint8_t(sum / (SCALE * SCALE));
                }
        return image;
    }

private:
    static constexpr int SCALE = 3;

    static double text_width(const std::string& text) { return double(text.size()) * (GLYPH_COLUMNS + 1) - 1.0; }

    template <class Inside>
    void fill(double x, double y, double reach, const Inside& is_inside, Color color, double opacity)
    {
        for (int j = int(y - reach); j <= int(y + reach); ++j)
            for (int i = int(x - reach); i <= int(x + reach); ++i)
                if (is_inside(i + 0.5 - x, j + 0.5 - y)) blend(i, j, color, opacity);
    }
    void square(double x, double y, int side)
    {
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) blend(int(x) + i, int(y) + j, INK, 1.0);
    }
    void blend(int x, int y, Color color, double opacity)
    {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
        uint8_t* const pixel = &pixels_[3 * (size_t(y) * size_t(width_) + size_t(x))];
        const uint8_t channels[] = {color.r, color.g, color.b};
        for (int i = 0; i < 3; ++i)
            pixel[i] = uint8_t(std::lround(std::lerp(double(pixel[i]), double(channels[i]), opacity)));
    }

    int width_, height_;
    std::vector<uint8_t> pixels_;
};

/// A logarithmic axis between two ticks. Both ticks lie slightly inside the frame, so that no mark overlaps the frame.
/// Ticks are powers of 10; axes of less than two decades also have ticks at 2 and 5 times these.
struct Axis {
    double lower = 0.0, upper = 1.0;  ///< exponents of 10
    double begin = 0.0, end = 1.0;    ///< pixels
    double at(double value) const
    {
        const double inset = std::copysign(12.0, end - begin), share = (std::log10(value) - lower) / (upper - lower);
        return std::lerp(begin + inset, end - inset, share);
    }
};

/// Returns the largest number 1, 2 or 5 times a power of 10 that is smaller than `value` by at least a thousandth.
double tick_at_most(double value)
{
    const double power = std::pow(10.0, std::floor(std::log10(value * 0.999)));
    for (const double part : {5.0, 2.0})
        if (part * power <= value * 0.999) return part * power;
    return power;
}

double tick_at_least(double value)
{
    return 1.0 / tick_at_most(1.0 / value);
}

Axis axis_of(const Plot& plot, double PlotPoint::*value, double begin, double end)
{
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const PlotSeries& series : plot.series)
        for (const PlotPoint& point : series.points)
            if (point.*value > 0.0) least = std::min(least, point.*value), most = std::max(most, point.*value);
    if (most == 0.0) least = most = 1.0;
    return {std::log10(tick_at_most(least)), std::log10(tick_at_least(most)), begin, end};
}

std::vector<double> ticks_of(const Axis& axis)
{
    const auto ticks_with = [&](std::initializer_list<double> parts) {
        std::vector<double> ticks;
        for (int exponent = int(std::floor(axis.lower)); exponent <= int(std::ceil(axis.upper)); ++exponent)
            for (const double part : parts) {
                const double tick = part * std::pow(10.0, exponent), place = std::log10(tick);
                if (place > axis.lower - 1e-9 && place < axis.upper + 1e-9) ticks.push_back(tick);
            }
        return ticks;
    };
    return axis.upper - axis.lower < 2.0 ? ticks_with({1.0, 2.0, 5.0}) : ticks_with({1.0});
}

std::string tick_text(double tick)
{
    const int exponent = int(std::floor(std::log10(tick * 1.0001)));
    if (exponent >= 0 && exponent <= 5) return sentence(int64_t(std::llround(tick)));
    const double part = std::round(tick / std::pow(10.0, exponent));
    return exponent < 0 && exponent >= -3 ? sentence(part * std::pow(10.0, exponent)) : sentence(part, "e", exponent);
}

void draw_axes(Canvas& canvas, const Plot& plot, const Axis& x, const Axis& y)
{
    for (const double tick : ticks_of(x)) {
        const double at = x.at(tick);
        canvas.line(at, y.begin, at, y.end, 1.0, GRID);
        canvas.text(at, y.begin + 16, tick_text(tick), 1);
    }
    for (int exponent = int(std::floor(x.lower)); exponent <= int(x.upper); ++exponent)
        for (int part = 1; part < 10; ++part) {
            const double minor = part * std::pow(10.0, exponent), place = std::log10(minor);
            if (place > x.lower && place < x.upper)
                canvas.line(x.at(minor), y.begin, x.at(minor), y.begin - 4, 1.0, INK);
        }
    for (const double tick : ticks_of(y)) {
        const double at = y.at(tick);
        canvas.line(x.begin, at, x.end, at, 1.0, GRID);
        canvas.text(x.begin - 6, at + 4, tick_text(tick), 2);
    }
    canvas.line(x.begin, y.begin, x.end, y.begin, 1.2, INK);
    canvas.line(x.begin, y.begin, x.begin, y.end, 1.2, INK);
    canvas.text(0.5 * (x.begin + x.end), y.begin + 36, plot.x_label, 1);
    canvas.text(16, 0.5 * (y.begin + y.end), plot.y_label, 1, true);
    canvas.text(x.begin, 22, plot.title, 0);
}

void draw_front(Canvas& canvas, const Plot& plot, const Axis& x, const Axis& y)
{
    std::vector<const PlotPoint*> front;
    for (const PlotSeries& series : plot.series)
        for (const PlotPoint& point : series.points)
            if (point.on_front && point.x > 0.0 && point.y > 0.0) front.push_back(&point);
    std::ranges::sort(front, {}, &PlotPoint::x);
    for (size_t i = 1; i < front.size(); ++i)
        canvas.line(x.at(front[i - 1]->x), y.at(front[i - 1]->y), x.at(front[i]->x), y.at(front[i]->y), 1.4, INK);
}

bool has_front(const Plot& plot)
{
    return std::ranges::any_of(
        plot.series, [](const PlotSeries& series) { return std::ranges::any_of(series.points, &PlotPoint::on_front); });
}

void draw_steps(Canvas& canvas, const PlotSeries& series, const Axis& x, const Axis& y, Color color)
{
    const PlotPoint* last = nullptr;
    for (const PlotPoint& point : series.points) {
        if (!(point.x > 0.0) || !(point.y > 0.0)) continue;
        if (last) canvas.line(x.at(last->x), y.at(last->y), x.at(point.x), y.at(point.y), 1.4, color);
        last = &point;
    }
}

void draw(Canvas& canvas, const Plot& plot)
{
    const double legend = 150.0;
    const Axis x = axis_of(plot, &PlotPoint::x, 74.0, plot.width - legend - 16.0);
    const Axis y = axis_of(plot, &PlotPoint::y, plot.height - 54.0, 36.0);
    draw_axes(canvas, plot, x, y);
    draw_front(canvas, plot, x, y);
    const auto color_of = [&](size_t i) { return plot.series[i].is_other ? INK : COLORS[i % COLORS.size()]; };
    for (size_t i = 0; i < plot.series.size(); ++i)
        if (plot.series[i].is_joined) draw_steps(canvas, plot.series[i], x, y, color_of(i));
    // Draws the important marks last, on top: those with a label, and those of the first series.
    for (const bool labelled : {false, true})
        for (size_t i = plot.series.size(); i-- > 0;)
            for (const PlotPoint& point : plot.series[i].points) {
                if (!(point.x > 0.0) || !(point.y > 0.0) || point.label.empty() == labelled) continue;
                const bool is_full = point.on_front || labelled || plot.series[i].is_joined || plot.series[i].is_other;
                canvas.mark(x.at(point.x), y.at(point.y), int(i % MARKS), 4.5, color_of(i), is_full ? 1.0 : 0.45);
                if (labelled) canvas.text(x.at(point.x) + 8, y.at(point.y) - 5, point.label, 0);
            }
    double row = 48.0;
    for (size_t i = 0; i < plot.series.size(); ++i) {
        canvas.mark(plot.width - legend, row - 4.0, int(i % MARKS), 4.5, color_of(i), 1.0);
        canvas.text(plot.width - legend + 12.0, row, plot.series[i].name, 0);
        row += 19.0;
    }
    if (!has_front(plot)) return;
    canvas.line(plot.width - legend - 6, row - 4, plot.width - legend + 6, row - 4, 1.4, INK);
    canvas.text(plot.width - legend + 12.0, row, "front", 0);
}

}  // namespace

std::string svg_of(const Plot& plot)
{
    SvgCanvas canvas;
    draw(canvas, plot);
    return sentence("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", plot.width, " ", plot.height,
                    "\" width=\"", plot.width, "\" height=\"", plot.height,
                    "\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" "
                    "fill=\"white\"/>\n",
                    canvas.markup, "</svg>\n");
}

Image8 picture_of(const Plot& plot)
{
    PixelCanvas canvas(plot.width, plot.height);
    draw(canvas, plot);
    return canvas.image();
}

}  // namespace shvr::report
