#include "engine/workbench/sight/figure_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/base/text.h"
#include "engine/look/camera_motion.h"
#include "engine/workbench/sight/figure_measures.h"
#include "engine/workbench/sight/figure_pane.h"
#include "engine/workbench/sight/figure_texts.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

constexpr std::array<glm::dvec3, 3> AXIS_COLORS{glm::dvec3(0.8, 0.05, 0.03), glm::dvec3(0.02, 0.45, 0.05),
                                                glm::dvec3(0.05, 0.2, 0.9)};
constexpr double TITLE_SCALE = 1.3, TITLE_STEP = 1.2 * TITLE_SCALE;  ///< height and distance of its lines, in lines
constexpr size_t MAX_TITLE_LINES = 3, MAX_TEXT_LINES = 5;
constexpr size_t MAX_TICKS = 5;
constexpr const char *VALUES = "Intensity", *OPACITY = "Opacity";  ///< captions of the colour bar

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
    PaneFigure(const DrawnElements& elements, const FigureScene& scene, const Pane& pane, double text_pixels,
               const TextDrawer& draw_texts, std::vector<std::string>& left_out)
        : elements_(elements),
          scene_(scene),
          pane_(pane),
          left_out_(left_out),
          drawn_(pane, scene.volume, scene.session.render.background, text_pixels, draw_texts),
          line_(text_pixels),
          edge_(drawn_.edge()),
          size_(drawn_.size())
    {}

    Figure::Part all(size_t index)
    {
        const bool is_first = index == 0;
        if (elements_.has_scale_bar && pane_.kind != Pane::Kind::map) scale_bar();
        if (is_first) {
            if (!elements_.title.empty()) title();
            if (elements_.has_axes) axes();
            if (elements_.has_color_bar) color_bar();
            if (elements_.has_legend) legend();
        }
        if (elements_.has_measurements && pane_.kind != Pane::Kind::map && !pane_.shot.right_eye)
            draw_measurements(drawn_, pane_, scene_.session.measurements, scene_.volume,
                              scene_.memory ? &scene_.memory->at(index) : nullptr, is_first, left_out_);
        if (is_first) {
            for (const TextInFigure& text : elements_.texts) text_at_point(text);
        }
        return drawn_.take_part();
    }

private:
    using Box = FigurePane::Box;
    using Words = FigurePane::Words;

    void leave_out(const char* element, const char* reason = "the picture is too small for it")
    {
        left_out_.push_back(sentence(element, " is left out: ", reason));
    }

    void scale_bar()
    {
        const Camera& camera = pane_.shot.camera;
        const bool holds_at_one_depth =
            camera.projection == Camera::Projection::perspective && pane_.kind != Pane::Kind::slice;
        const double unit = pixel_size(camera, pane_.pixels(), glm::distance(camera.eye, camera.target));
        const ScaleBar bar = shvr::ui::scale_bar(unit, 0.3 * size_.x, scene_.volume.unit);
        if (bar.pixels < line_ || size_.y < 4.0 * line_) return leave_out("the scale bar");
        std::string words = bar.text + (holds_at_one_depth ? HOLDS_AT_TARGET : "");
        const double room = size_.x - 2.0 * edge_;
        if (holds_at_one_depth && width_of(words) > room) {
            words = bar.text;
            left_out_.push_back(
                sentence("the scale bar holds", HOLDS_AT_TARGET, ": the picture is too small to say it"));
        }
        const double words_width = width_of(words);
        if (words_width > room) return leave_out("the scale bar");
        const glm::dvec2 end(size_.x - edge_, size_.y - edge_), rim(drawn_.rim_width());
        const glm::dvec2 begin(end.x - bar.pixels, end.y - std::max(2.0, std::round(0.15 * line_)));
        const FigurePane::Ink ink = drawn_.ink_at(0.5 * (begin + end));
        drawn_.rectangle(begin - rim, end + rim, ink.rim);
        drawn_.rectangle(begin, end, ink.color);
        // The words end with the bar, since they are often longer.
        const double above = begin.y - 0.2 * line_;
        drawn_.write({{{end.x, above}, {1.0, 1.0}, words}}, line_);
        drawn_.take({{end.x - std::max(words_width, bar.pixels), above - line_}, end});
    }

    void title()
    {
        const double height = TITLE_SCALE * line_, room = size_.x - 2.0 * edge_;
        const FittedLines fitted = lines_of(elements_.title, room, height, MAX_TITLE_LINES, drawn_.draw_texts());
        const double bottom = 0.5 * edge_ + TITLE_STEP * line_ * double(fitted.lines.size());
        if (fitted.lines.empty() || !drawn_.is_free({{edge_, 0.0}, {edge_ + room, bottom}}))
            return leave_out("the title");
        if (fitted.is_shortened) left_out_.emplace_back("the title is shortened: the picture is too small for it");
        std::vector<Words> lines;
        for (size_t i = 0; i < fitted.lines.size(); ++i)
            lines.push_back(
                {{0.5 * size_.x, 0.5 * edge_ + TITLE_STEP * line_ * double(i)}, {0.5, 0.0}, fitted.lines[i]});
        drawn_.write(lines, height);
        const double half = 0.5 * drawn_.widest_of(fitted.lines, height);
        drawn_.take({{0.5 * size_.x - half, 0.0}, {0.5 * size_.x + half, bottom}});
        below_title_ = bottom + 0.5 * line_;
    }

    void legend()
    {
        if (scene_.groups.empty()) return leave_out("the legend", "no group is painted or traced, and visible");
        const double square = std::round(0.8 * line_), next = 1.4 * line_;
        const double free_height = size_.y - below_title_ - edge_ - 3.0 * line_;  // the scale bar is below
        const size_t drawn = std::min(size_t(std::max(free_height / next, 0.0)), scene_.groups.size());
        const glm::dvec2 corner(size_.x - edge_, below_title_);
        const double room = 0.5 * size_.x - edge_ - square - 0.5 * line_;
        if (drawn == 0 || room < 2.0 * line_) return leave_out("the legend");
        std::vector<ColorGroup> looks;
        std::vector<std::string> names;
        bool is_shortened = false;
        for (const uint8_t group : scene_.groups.first(drawn)) {
            looks.push_back(group_of(scene_.session.shown_groups(), group));
            names.push_back(shortened(looks.back().name, room, line_, drawn_.draw_texts()));
            is_shortened = is_shortened || names.back() != looks.back().name;
        }
        const double widest = drawn_.widest_of(names, line_);
        const Box box{corner - glm::dvec2(square + 0.5 * line_ + widest, 0.0),
                      corner + glm::dvec2(0.0, next * double(drawn))};
        if (!drawn_.is_free(box)) return leave_out("the legend");
        if (drawn < scene_.groups.size())
            left_out_.push_back(sentence("the legend lacks ", counted(int64_t(scene_.groups.size() - drawn), "group"),
                                         ": the picture is too small for all ", scene_.groups.size()));
        if (is_shortened)
            left_out_.emplace_back("names of the legend are shortened: the picture is too small for them");
        std::vector<Words> words;
        for (size_t i = 0; i < drawn; ++i) {
            const glm::dvec2 at = corner + glm::dvec2(0.0, next * double(i));
            const glm::dvec2 begin = at - glm::dvec2(square, 0.0), end = at + glm::dvec2(0.0, square);
            drawn_.rectangle(begin - 1.0, end + 1.0, drawn_.ink_at(begin).color);
            drawn_.rectangle(begin, end, looks[i].color);
            words.push_back({begin + glm::dvec2(-0.5 * line_, 0.5 * square), {1.0, 0.5}, names[i]});
        }
        drawn_.write(words, line_);
        drawn_.take(box);
    }

    struct Tick {
        double value = 0.0;
        std::string text;
    };
    static std::vector<Tick> ticks_of(double lower, double upper)
    {
        std::vector<Tick> ticks;
        const double step = tick_step(upper - lower);
        for (double tick = std::ceil(lower / step) * step; tick <= upper + 1e-9 * step; tick += step)
            ticks.push_back({tick, tick_in_words(tick)});
        return ticks;
    }
    /// A vertical bar on the left side, in the middle where there is room, with up to MAX_TICKS + 1 numbers. The wider
    /// column has the colours, where they are not fully transparent; the narrower one's width is the opacity, relative
    /// to its maximum. The values' name is above it and the opacity's below its column, where there is room.
    void color_bar()
    {
        const TransferFunction& function = scene_.session.transfer_function;
        if (function.draws_nothing()) return leave_out("the colour bar", "the transfer function draws nothing");
        const double least = 4.0 * line_, caption = 1.1 * line_;
        const double below = above_axes_ - 0.5 * line_;  // half a number
        double above = below_title_ + 0.5 * line_;
        const bool is_named = below - above >= least + caption && edge_ + width_of(VALUES) <= 0.5 * size_.x;
        if (is_named) above += caption;
        const double height = std::round(std::min(0.4 * size_.y, below - above));
        const double lower = function.lower(), range = function.upper() - lower;
        const std::vector<Tick> ticks = ticks_of(lower, function.upper());
        std::vector<std::string> texts;
        for (const Tick& tick : ticks) texts.push_back(tick.text);
        const double widest = drawn_.widest_of(texts, line_);
        const glm::dvec2 colors(std::round(1.2 * line_), height), opacities(std::round(0.7 * line_), height);
        const glm::dvec2 begin =
            glm::round(glm::dvec2(edge_, std::clamp(0.5 * (size_.y - height), above, std::max(above, below - height))));
        const double right = begin.x + colors.x + 1.0 + opacities.x;
        const Box box{begin - glm::dvec2(0.0, 0.5 * line_),
                      {right + 0.5 * line_ + widest, begin.y + height + 0.5 * line_}};
        if (height < least || !drawn_.is_free(box)) return leave_out("the colour bar");
        fill_color_bar(begin, colors, opacities);
        std::vector<Words> numbers;
        for (const Tick& tick : ticks) {
            const double y = begin.y + height * (1.0 - (tick.value - lower) / range);
            const glm::dvec2 from(right + 1.0, y - 0.5), to = from + glm::dvec2(0.3 * line_, 1.0);
            drawn_.rectangle(from, to, drawn_.ink_at(from).color);
            numbers.push_back({{to.x + 0.2 * line_, y}, {0.0, 0.5}, tick.text});
        }
        drawn_.write(numbers, line_);
        drawn_.take(box);
        if (is_named) write_caption(VALUES, {begin.x, box.begin.y - caption});
        const double left = right - 0.5 * (opacities.x + width_of(OPACITY));
        write_caption(OPACITY, {std::max(left, edge_), box.end.y + caption - line_});
    }
    double width_of(const std::string& text) const { return drawn_.widest_of(std::span(&text, 1), line_); }
    /// Writes a caption of the colour bar if its place is free, and not in the right half, where the legend may be.
    void write_caption(const std::string& text, const glm::dvec2& begin)
    {
        const Box box{begin, begin + glm::dvec2(width_of(text), line_)};
        if (box.end.x > 0.5 * size_.x || box.end.y > above_axes_ || !drawn_.is_free(box)) return;
        drawn_.write({{begin, {0.0, 0.0}, text}}, line_);
        drawn_.take(box);
    }
    void fill_color_bar(const glm::dvec2& begin, const glm::dvec2& colors, const glm::dvec2& opacities)
    {
        const TransferFunction& function = scene_.session.transfer_function;
        const double lower = function.lower(), range = function.upper() - lower;
        double most = 0.0;
        for (const ControlPoint& point : function.points()) most = std::max(most, point.opacity);
        const FigurePane::Ink ink = drawn_.ink_at(begin);
        drawn_.rectangle(begin - 1.0, begin + colors + 1.0, ink.color);
        const glm::dvec2 beside = begin + glm::dvec2(colors.x + 1.0, 0.0);
        drawn_.rectangle(beside, beside + opacities, ink.rim);
        for (int row = 0; row < int(colors.y); ++row) {
            const glm::dvec4 look = function.at(lower + range * (1.0 - (row + 0.5) / colors.y));
            const glm::dvec2 down(0.0, row);
            drawn_.rectangle(begin + down, begin + down + glm::dvec2(colors.x, 1.0),
                             look.a > 0.0 ? glm::dvec3(look) : ink.rim);
            drawn_.rectangle(beside + down, beside + down + glm::dvec2(opacities.x * look.a / most, 1.0), ink.color);
        }
    }

    /// Axes along the line of sight appear as points and are left out.
    void axes()
    {
        const double length = 2.2 * line_, reach = length + line_;
        const glm::dvec2 middle(edge_ + reach, size_.y - edge_ - reach);
        const Box box{middle - reach, middle + reach};
        if (std::min(size_.x, size_.y) < 4.0 * length || !drawn_.is_free(box))
            return left_out_.push_back("the axes are left out: the picture is too small for them");
        const CameraAxes of_camera = axes_of(pane_.shot.camera);
        std::vector<Words> names;
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 direction(0.0);
            direction[axis] = 1.0;
            const glm::dvec2 way(glm::dot(direction, of_camera.right), -glm::dot(direction, of_camera.up));
            if (glm::length(way) < 0.05) continue;
            drawn_.line(middle, middle + length * way, AXIS_COLORS[size_t(axis)], std::max(1.5, 0.15 * line_));
            names.push_back({middle + (length + 0.6 * line_) * way, {0.5, 0.5}, std::string(1, "xyz"[axis])});
        }
        drawn_.write(names, line_);
        drawn_.take(box);
        above_axes_ = box.begin.y;
    }

    void text_at_point(const TextInFigure& text)
    {
        const auto at = project(pane_.shot.camera, pane_.pixels(), text.voxel * scene_.volume.spacing);
        const bool is_inside = at && glm::all(glm::greaterThanEqual(at->pixel, glm::dvec2(0.0))) &&
                               glm::all(glm::lessThanEqual(at->pixel, size_));
        if (!is_inside)
            return left_out_.push_back(
                sentence("the text ", in_quotes(text.text), " is left out: its point is outside of the picture"));
        const double radius = 0.2 * line_;
        drawn_.dot(at->pixel, radius);
        // To the right of the point where there is room for it, so that it changes its side rarely in movies; on the
        // other side, or above or below, if something is there.
        const double right_room = size_.x - at->pixel.x - radius - 0.3 * line_;
        const bool is_right = width_of(text.text) <= right_room || 2.0 * at->pixel.x < size_.x;
        for (const double lines : {0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0}) {
            const glm::dvec2 place = at->pixel + glm::dvec2(0.0, lines * line_);
            for (const bool right : {is_right, !is_right})
                if (write_beside(text.text, place, radius + 0.3 * line_, right, true)) return;
        }
        write_beside(text.text, at->pixel, radius + 0.3 * line_, is_right, false);
    }
    /// Returns whether the text was written: moved up or down into the picture, if it would leave that. `if_free`: only
    /// if it can be written in full, and hides no element.
    bool write_beside(const std::string& text, const glm::dvec2& at, double distance, bool is_right, bool if_free)
    {
        const double room = (is_right ? size_.x - at.x : at.x) - distance;
        const FittedLines fitted = lines_of(text, room, line_, MAX_TEXT_LINES, drawn_.draw_texts());
        std::vector<Words> lines;
        const double height = line_ * double(fitted.lines.size());
        Box box{at + glm::dvec2(is_right ? distance : -distance, -0.5 * height), {}};
        box.begin.y = std::max(std::min(box.begin.y, size_.y - height), 0.0);
        for (const std::string& line : fitted.lines)
            lines.push_back(
                {box.begin + glm::dvec2(0.0, line_ * double(lines.size())), {is_right ? 0.0 : 1.0, 0.0}, line});
        const double widest = drawn_.widest_of(fitted.lines, line_);
        box.end = box.begin + glm::dvec2(is_right ? widest : 0.0, line_ * double(lines.size()));
        if (!is_right) box.begin.x -= widest;
        const bool is_whole = !lines.empty() && !fitted.is_shortened;
        if (if_free && (!is_whole || !drawn_.is_free(box))) return false;
        if (!is_whole)
            left_out_.push_back(sentence("the text ", in_quotes(text), lines.empty() ? " is left out" : " is shortened",
                                         ": the picture is too small for it"));
        else if (!if_free)
            left_out_.push_back(sentence("the text ", in_quotes(text), " covers another element: no place is free"));
        drawn_.write(lines, line_);
        drawn_.take(box);
        return true;
    }

    const DrawnElements& elements_;
    const FigureScene& scene_;
    const Pane& pane_;
    std::vector<std::string>& left_out_;
    FigurePane drawn_;
    double line_, edge_;  ///< height of a line of text; distance from the picture's edge
    glm::dvec2 size_;
    double below_title_ = edge_, above_axes_ = size_.y - edge_;
};

}  // namespace

double automatic_text_pixels(const glm::uvec2& size)
{
    return std::max(10.0, std::round(double(std::min(size.x, size.y)) / 28.0));
}

Figure figure_of(const DrawnElements& elements, const FigureScene& scene, const TextDrawer& draw_texts,
                 std::vector<std::string>& left_out)
{
    Figure figure;
    const double text_pixels = elements.text_pixels > 0.0 || scene.panes.empty()
                                   ? elements.text_pixels
                                   : automatic_text_pixels(scene.panes.front().pixels());
    if (scene.memory) scene.memory->resize(scene.panes.size());
    for (size_t i = 0; i < scene.panes.size(); ++i)
        figure.parts.push_back(PaneFigure(elements, scene, scene.panes[i], text_pixels, draw_texts, left_out).all(i));
    return figure;
}

}  // namespace shvr::ui
