#include "engine/workbench/sight/figure_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/base/text.h"
#include "engine/look/camera_motion.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

constexpr glm::dvec3 BLACK(0.0), WHITE(1.0);
constexpr std::array<glm::dvec3, 3> AXIS_COLORS{glm::dvec3(0.8, 0.05, 0.03), glm::dvec3(0.02, 0.45, 0.05),
                                                glm::dvec3(0.05, 0.2, 0.9)};
constexpr double TITLE_SCALE = 1.3;
constexpr uint8_t OPAQUE = 255, RIM = 200;
constexpr size_t MAX_TICKS = 5;

/// Returns 1, 2 or 5 times a power of ten: the smallest step of which at most MAX_TICKS fit into `range`.
double tick_step(double range)
{
    const double least = range / double(MAX_TICKS), power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= least) return factor * power;
    return 10.0 * power;
}

std::string tick_in_words(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value == 0.0 ? 0.0 : value);
    return text;
}

/// Draws the elements of one pane.
class PaneFigure {
public:
    PaneFigure(const FigureElements& elements, const FigureScene& scene, const Pane& pane, double text_pixels,
               const TextDrawer& draw_texts, std::vector<std::string>& left_out)
        : elements_(elements),
          scene_(scene),
          pane_(pane),
          draw_texts_(draw_texts),
          left_out_(left_out),
          line_(text_pixels),
          edge_(0.8 * text_pixels),
          size_(pane.pixels()),
          part_{.box = pane.box, .strokes = {}, .stamps = {}}
    {
        const glm::dvec4& background = scene.session.render.background;
        const double luminance = glm::dot(glm::dvec3(background), glm::dvec3(0.2126, 0.7152, 0.0722));
        const bool is_light = background.a < 0.5 || luminance > 0.18;  // transparent pictures are put on paper
        ink_ = is_light ? BLACK : WHITE;
        rim_ = is_light ? WHITE : BLACK;
    }

    Figure::Part all(bool is_first)
    {
        if (elements_.scale_bar && pane_.kind != Pane::Kind::map) scale_bar();
        if (is_first) {
            if (!elements_.title.empty()) title();
            if (elements_.legend) legend();
            if (elements_.color_bar) color_bar();
            if (elements_.axes) axes();
            for (const FigureText& text : elements_.texts) text_at_point(text);
        }
        return std::move(part_);
    }

private:
    /// A rectangle with fractional sides: pixels at its borders are partly covered.
    void rectangle(const glm::dvec2& begin, const glm::dvec2& end, const glm::dvec3& color)
    {
        Stamp stamp{.begin = glm::ivec2(glm::floor(begin)), .pixels{}, .coverage{}, .color = color};
        stamp.pixels = glm::ivec2(glm::ceil(end)) - stamp.begin;
        const auto overlap = [](double pixel, double from, double to) {
            return std::max(std::min(pixel + 1.0, to) - std::max(pixel, from), 0.0);
        };
        for (int y = 0; y < stamp.pixels.y; ++y)
            for (int x = 0; x < stamp.pixels.x; ++x) {
                const double covered =
                    overlap(stamp.begin.x + x, begin.x, end.x) * overlap(stamp.begin.y + y, begin.y, end.y);
                stamp.coverage.push_back(uint8_t(std::lround(OPAQUE * covered)));
            }
        part_.stamps.push_back(std::move(stamp));
    }
    double rim_width() const { return std::max(1.0, std::round(line_ / 12.0)); }

    /// The texts of one size, drawn together. Each has an anchor: 0, 0 is its upper left corner, 1, 1 the lower right.
    struct Words {
        glm::dvec2 at, anchor;
        std::string text;
    };
    void write(const std::vector<Words>& words, double pixels)
    {
        std::vector<std::string> texts;
        for (const Words& each : words) texts.push_back(each.text);
        std::vector<TextImage> images = draw_texts_(texts, pixels);
        for (size_t i = 0; i < words.size(); ++i) {
            const glm::dvec2 begin = words[i].at - words[i].anchor * glm::dvec2(images[i].pixels);
            Stamp ink{.begin = glm::ivec2(glm::round(begin)),
                      .pixels = images[i].pixels,
                      .coverage = std::move(images[i].coverage),
                      .color = ink_};
            part_.stamps.push_back(rim_of(ink));
            part_.stamps.push_back(std::move(ink));
        }
    }
    /// Returns the shape, grown by the width of the rim.
    Stamp rim_of(const Stamp& ink) const
    {
        const int grown = int(rim_width());
        Stamp rim{.begin = ink.begin - grown, .pixels = ink.pixels + 2 * grown, .coverage{}, .color = rim_};
        rim.coverage.assign(size_t(rim.pixels.x) * size_t(rim.pixels.y), 0);
        for (int y = 0; y < ink.pixels.y; ++y)
            for (int x = 0; x < ink.pixels.x; ++x) {
                const int covered = ink.coverage[size_t(x) + size_t(ink.pixels.x) * size_t(y)] * RIM / OPAQUE;
                for (int dy = 0; covered > 0 && dy <= 2 * grown; ++dy)
                    for (int dx = 0; dx <= 2 * grown; ++dx) {
                        uint8_t& pixel = rim.coverage[size_t(x + dx) + size_t(rim.pixels.x) * size_t(y + dy)];
                        pixel = std::max(pixel, uint8_t(covered));
                    }
            }
        return rim;
    }

    void scale_bar()
    {
        const Camera& camera = pane_.shot.camera;
        const bool holds_at_one_depth =
            camera.projection == Camera::Projection::perspective && pane_.kind != Pane::Kind::slice;
        const double unit = pixel_size(camera, size_, glm::distance(camera.eye, camera.target));
        const ScaleBar bar = shvr::ui::scale_bar(unit, 0.3 * double(size_.x), scene_.volume.unit);
        if (bar.pixels < line_ || double(size_.y) < 4.0 * line_)
            return static_cast<void>(
                left_out_.emplace_back("the scale bar is left out: the picture is too small for it"));
        const glm::dvec2 end(double(size_.x) - edge_, double(size_.y) - edge_), rim(rim_width());
        const glm::dvec2 begin(end.x - bar.pixels, end.y - std::max(2.0, std::round(0.15 * line_)));
        rectangle(begin - rim, end + rim, rim_);
        rectangle(begin, end, ink_);
        // The words end with the bar, since they are often longer.
        const std::string words = bar.text + (holds_at_one_depth ? ", in the plane of the target" : "");
        write({{{end.x, begin.y - 0.2 * line_}, {1.0, 1.0}, words}}, line_);
    }

    void title() { write({{{0.5 * double(size_.x), 0.5 * edge_}, {0.5, 0.0}, elements_.title}}, TITLE_SCALE * line_); }
    double below_title() const { return elements_.title.empty() ? edge_ : edge_ + 1.5 * TITLE_SCALE * line_; }

    void legend()
    {
        if (scene_.groups.empty())
            return static_cast<void>(
                left_out_.emplace_back("the legend is left out: no group is painted or traced, and visible"));
        const double square = std::round(0.8 * line_), next = 1.4 * line_;
        const double free_height = double(size_.y) - below_title() - edge_ - 3.0 * line_;  // the scale bar is below
        const size_t most = size_t(std::max(free_height / next, 0.0));
        if (most < scene_.groups.size())
            left_out_.push_back(sentence("the legend lacks ", counted(int64_t(scene_.groups.size() - most), "group"),
                                         ": the picture is too small for all ", scene_.groups.size()));
        glm::dvec2 at(double(size_.x) - edge_, below_title());
        std::vector<Words> names;
        for (const uint8_t group : scene_.groups.first(std::min(most, scene_.groups.size()))) {
            const ColorGroup look = group_of(scene_.session.shown_groups(), group);
            const glm::dvec2 begin = at - glm::dvec2(square, 0.0), end = at + glm::dvec2(0.0, square);
            rectangle(begin - 1.0, end + 1.0, ink_);
            rectangle(begin, end, look.color);
            names.push_back({begin + glm::dvec2(-0.5 * line_, 0.5 * square), {1.0, 0.5}, look.name});
            at.y += next;
        }
        write(names, line_);
    }

    /// A vertical bar in the middle of the left side, with up to MAX_TICKS + 1 numbers.
    void color_bar()
    {
        const TransferFunction& function = scene_.session.transfer_function;
        const double height = std::round(0.4 * double(size_.y)), width = std::round(1.2 * line_);
        if (function.draws_nothing())
            return static_cast<void>(
                left_out_.emplace_back("the colour bar is left out: the transfer function draws nothing"));
        if (height < 4.0 * line_)
            return static_cast<void>(
                left_out_.emplace_back("the colour bar is left out: the picture is too small for it"));
        const glm::dvec2 begin = glm::round(glm::dvec2(edge_, 0.5 * (double(size_.y) - height)));
        rectangle(begin - 1.0, begin + glm::dvec2(width, height) + 1.0, ink_);
        double most = 0.0;
        for (const ControlPoint& point : function.points()) most = std::max(most, point.opacity);
        const double lower = function.lower(), range = function.upper() - lower;
        for (int row = 0; row < int(height); ++row) {
            const glm::dvec4 look = function.at(lower + range * (1.0 - (row + 0.5) / height));
            const glm::dvec2 at = begin + glm::dvec2(0.0, row);
            rectangle(at, at + glm::dvec2(width, 1.0), glm::mix(rim_, glm::dvec3(look), look.a / most));
        }
        std::vector<Words> numbers;
        const double step = tick_step(range);
        for (double tick = std::ceil(lower / step) * step; tick <= function.upper() + 1e-9 * step; tick += step) {
            const double y = begin.y + height * (1.0 - (tick - lower) / range);
            const glm::dvec2 from(begin.x + width + 1.0, y - 0.5), to = from + glm::dvec2(0.3 * line_, 1.0);
            rectangle(from, to, ink_);
            numbers.push_back({{to.x + 0.2 * line_, y}, {0.0, 0.5}, tick_in_words(tick)});
        }
        write(numbers, line_);
    }

    void arrow(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color, double width)
    {
        part_.strokes.push_back({from, to, rim_, width + 2.0 * rim_width()});
        part_.strokes.push_back({from, to, color, width});
    }
    /// Axes along the line of sight appear as points and are left out.
    void axes()
    {
        const double length = 2.2 * line_;
        if (double(std::min(size_.x, size_.y)) < 4.0 * length)
            return static_cast<void>(
                left_out_.emplace_back("the axes are left out: the picture is too small for them"));
        const CameraAxes of_camera = axes_of(pane_.shot.camera);
        const glm::dvec2 middle(edge_ + length + line_, double(size_.y) - edge_ - length - line_);
        std::vector<Words> names;
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 direction(0.0);
            direction[axis] = 1.0;
            const glm::dvec2 way(glm::dot(direction, of_camera.right), -glm::dot(direction, of_camera.up));
            if (glm::length(way) < 0.05) continue;
            arrow(middle, middle + length * way, AXIS_COLORS[size_t(axis)], std::max(1.5, 0.15 * line_));
            names.push_back({middle + (length + 0.6 * line_) * way, {0.5, 0.5}, std::string(1, "xyz"[axis])});
        }
        write(names, line_);
    }

    void text_at_point(const FigureText& text)
    {
        const auto at = project(pane_.shot.camera, size_, text.voxel * scene_.volume.spacing);
        const bool is_inside = at && glm::all(glm::greaterThanEqual(at->pixel, glm::dvec2(0.0))) &&
                               glm::all(glm::lessThanEqual(at->pixel, glm::dvec2(size_)));
        if (!is_inside)
            return left_out_.push_back(
                sentence("the text ", in_quotes(text.text), " is left out: its point is outside of the picture"));
        const double radius = 0.2 * line_;
        arrow(at->pixel, at->pixel + glm::dvec2(0.01, 0.0), ink_, 2.0 * radius);
        // To the left of the point where the right side has less room.
        const bool is_right = at->pixel.x < 0.5 * double(size_.x);
        const double beside = radius + 0.3 * line_;
        write({{at->pixel + glm::dvec2(is_right ? beside : -beside, 0.0), {is_right ? 0.0 : 1.0, 0.5}, text.text}},
              line_);
    }

    const FigureElements& elements_;
    const FigureScene& scene_;
    const Pane& pane_;
    const TextDrawer& draw_texts_;
    std::vector<std::string>& left_out_;
    double line_, edge_;  ///< height of a line of text; distance from the picture's edge
    glm::uvec2 size_;
    glm::dvec3 ink_, rim_;
    Figure::Part part_;
};

}  // namespace

double automatic_text_pixels(const glm::uvec2& size)
{
    return std::max(10.0, std::round(double(std::min(size.x, size.y)) / 28.0));
}

Figure figure_of(const FigureElements& elements, const FigureScene& scene, const TextDrawer& draw_texts,
                 std::vector<std::string>& left_out)
{
    Figure figure;
    const double text_pixels =
        elements.text_pixels > 0.0 ? elements.text_pixels : automatic_text_pixels(scene.session.render.size);
    for (const Pane& pane : scene.panes)
        figure.parts.push_back(
            PaneFigure(elements, scene, pane, text_pixels, draw_texts, left_out).all(&pane == scene.panes.data()));
    return figure;
}

}  // namespace shvr::ui
