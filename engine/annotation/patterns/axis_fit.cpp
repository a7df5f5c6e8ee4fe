#include "engine/annotation/patterns/axis_fit.h"

#include <algorithm>
#include <cmath>

namespace shvr {

namespace {

constexpr double MIN_ERROR = 1e-6;  ///< smaller errors are taken for this one, so that exact traces have weights
/// In costs, smaller errors are taken for this one: no hand is more exact, and in flat heads veins lie exactly in
/// planes through lines that are no axis.
constexpr double MIN_HAND_ERROR = 0.005;
constexpr double CAUCHY = 2.385;  ///< 95 % efficiency for normal errors
constexpr size_t MIN_POINTS = 8;

/// A residual, its derivatives by (turn along x, turn along y, shift along x, shift along y), and its own weight.
struct Row {
    double residual = 0.0;
    glm::dvec4 slope{0.0};
    double share = 1.0;
};

/// Median of the absolute residuals, as the standard deviation of a normal distribution.
double error_of(const std::vector<Row>& rows)
{
    std::vector<double> sizes;
    for (const Row& row : rows)
        if (row.share > 0.5) sizes.push_back(std::abs(row.residual));
    if (sizes.empty()) return MIN_ERROR;
    const auto middle = sizes.begin() + ptrdiff_t(sizes.size() / 2);
    std::ranges::nth_element(sizes, middle);
    return std::max(MIN_ERROR, 1.4826 * *middle);
}

double weight_of(double residual, double error)
{
    const double r = residual / (CAUCHY * error);
    return 1.0 / (1.0 + r * r);
}

/// Normal equations of a step, and the cost of the present axis.
struct Equations {
    glm::dmat4 normal{0.0};
    glm::dvec4 right{0.0};
    double cost = 0.0;

    void add(const Row& row, double weight)
    {
        normal += weight * glm::outerProduct(row.slope, row.slope);
        right -= weight * row.residual * row.slope;
    }
    void add_cost(const std::vector<Row>& rows, double error)
    {
        error = std::max(error, MIN_HAND_ERROR);
        for (const Row& row : rows) {
            const double r = row.residual / (CAUCHY * error);
            cost += row.share * (std::log(error) + 0.5 * CAUCHY * CAUCHY * std::log1p(r * r));
        }
    }
};

struct Frame {
    glm::dvec3 x, y, up, centre;
    glm::dvec3 local(const glm::dvec3& at) const
    {
        const glm::dvec3 p = at - centre;
        return {glm::dot(p, x), glm::dot(p, y), glm::dot(p, up)};
    }
};
Frame frame_of(const HeadAxis& axis)
{
    const auto [x, y] = across(axis.direction);
    return {x, y, axis.direction, axis.centre};
}

/// Adds the distances of a vein's points from its best plane through the axis, and how they change as the plane turns.
void add_vein(const AxisData::Vein& vein, const Frame& frame, std::vector<Row>& rows, std::vector<double>& turns)
{
    std::vector<glm::dvec3> points;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const glm::dvec3& at : vein.points) {
        const glm::dvec3 q = frame.local(at);
        points.push_back(q);
        xx += q.x * q.x;
        xy += q.x * q.y;
        yy += q.y * q.y;
    }
    const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
    const glm::dvec2 n(-std::sin(along), std::cos(along));
    for (const glm::dvec3& q : points) {
        rows.push_back({.residual = n.x * q.x + n.y * q.y, .slope = {-n.x * q.z, -n.y * q.z, -n.x, -n.y}});
        turns.push_back(-(n.y * q.x - n.x * q.y));
    }
}

/// Adds the veins, after eliminating the unknown turn of each plane around the axis.
void add_veins(const AxisData& data, const Frame& frame, int without, Equations& equations)
{
    std::vector<Row> rows;
    std::vector<double> turns;
    struct Rows {
        size_t from, to;
    };
    std::vector<Rows> veins;
    for (const AxisData::Vein& vein : data.veins) {
        if (vein.of == without) continue;
        const size_t from = rows.size();
        add_vein(vein, frame, rows, turns);
        veins.push_back({from, rows.size()});
    }
    const double error = error_of(rows);
    for (const Rows& vein : veins) {
        glm::dvec4 mixed(0.0);
        double turning = 0.0, turned = 0.0;
        for (size_t i = vein.from; i < vein.to; ++i) {
            const double weight = weight_of(rows[i].residual, error) / (error * error);
            equations.add(rows[i], weight);
            mixed += weight * turns[i] * rows[i].slope;
            turning += weight * turns[i] * turns[i];
            turned -= weight * turns[i] * rows[i].residual;
        }
        if (!(turning > 0.0)) continue;
        equations.normal -= glm::outerProduct(mixed, mixed) / turning;
        equations.right -= mixed * (turned / turning);
    }
    equations.add_cost(rows, error);
}

enum class Profile { even, any };

/// Powers of rho that a surface's height is made of, and their derivatives.
std::pair<glm::dvec4, glm::dvec4> powers_of(double rho, Profile profile)
{
    const double square = rho * rho;
    if (profile == Profile::even)
        return {{1.0, square, square * square, 0.0}, {0.0, 2.0 * rho, 4.0 * square * rho, 0.0}};
    return {{1.0, rho, square, square * rho}, {0.0, 1.0, 2.0 * rho, 3.0 * square}};
}

/// A surface of revolution through points.
class Surface {
public:
    Surface(const std::vector<AxisData::Point>& points, double rho_from, const Frame& frame, int without)
    {
        for (const AxisData::Point& point : points) {
            if (point.of == without) continue;
            const glm::dvec3 p = frame.local(point.at);
            const double rho = std::hypot(p.x, p.y);
            const double share = rho_from > 0.0 ? std::clamp((rho / rho_from - 0.7) / 0.6, 0.0, 1.0) : 1.0;
            if (share > 0.0 && rho > 1e-9) places_.push_back({p, rho, share});
        }
    }
    bool is_determined() const { return places_.size() >= MIN_POINTS; }

    /// Fits the height by least squares with Cauchy's weights. Returns the points' error.
    double fit(Profile profile)
    {
        double error = 0.0;
        rows_.resize(places_.size());
        terms_.resize(places_.size());
        for (int pass = 0; pass < 4; ++pass) {
            glm::dmat4 normal(1e-9 * double(places_.size()));
            glm::dvec4 right(0.0);
            for (size_t i = 0; i < places_.size(); ++i) {
                const auto [values, slopes] = powers_of(places_[i].rho, profile);
                const double steep = std::hypot(1.0, glm::dot(height_, slopes));
                const double robust = pass > 0 ? weight_of(rows_[i].residual, error) / (steep * steep) : 1.0;
                normal += places_[i].share * robust * glm::outerProduct(values, values);
                right += places_[i].share * robust * places_[i].at.z * values;
            }
            height_ = glm::inverse(normal) * right;
            for (size_t i = 0; i < places_.size(); ++i) set_row(i, profile);
            error = error_of(rows_);
        }
        return error;
    }

    /// Adds the distances of the points from the surface, after eliminating the surface's own unknowns.
    void add_to(Equations& equations, double error) const
    {
        glm::dmat4 own(0.0), mixed(0.0);
        glm::dvec4 own_right(0.0);
        for (size_t i = 0; i < rows_.size(); ++i) {
            const double weight = rows_[i].share * weight_of(rows_[i].residual, error) / (error * error);
            equations.add(rows_[i], weight);
            own += weight * glm::outerProduct(terms_[i], terms_[i]);
            mixed += weight * glm::outerProduct(rows_[i].slope, terms_[i]);  // columns go with the surface's unknowns
            own_right -= weight * rows_[i].residual * terms_[i];
        }
        own += glm::dmat4(1e-9 * double(rows_.size()) / (error * error));
        const glm::dmat4 through = mixed * glm::inverse(own);
        equations.normal -= through * glm::transpose(mixed);
        equations.right -= through * own_right;
        equations.add_cost(rows_, error);
    }

private:
    struct Place {
        glm::dvec3 at;
        double rho, share;
    };
    void set_row(size_t i, Profile profile)
    {
        const auto& [p, rho, share] = places_[i];
        const auto [values, slopes] = powers_of(rho, profile);
        const double slope = glm::dot(height_, slopes), steep = std::hypot(1.0, slope);
        const glm::dvec2 out = glm::dvec2(p) / rho;
        const glm::dvec4 change(p.x + slope * out.x * p.z, p.y + slope * out.y * p.z, slope * out.x, slope * out.y);
        rows_[i] = {(p.z - glm::dot(height_, values)) / steep, change / steep, share};
        terms_[i] = -values / steep;
    }

    std::vector<Place> places_;
    std::vector<Row> rows_;
    std::vector<glm::dvec4> terms_;  ///< change of each residual with the surface's unknowns
    glm::dvec4 height_{0.0};         ///< factors of `powers_of`
};

void add_surface(const std::vector<AxisData::Point>& points, Profile profile, double rho_from, const Frame& frame,
                 int without, Equations& equations)
{
    Surface surface(points, rho_from, frame, without);
    if (surface.is_determined()) surface.add_to(equations, surface.fit(profile));
}

Equations equations_of(const AxisData& data, const HeadAxis& axis, int without)
{
    const Frame frame = frame_of(axis);
    Equations equations;
    add_veins(data, frame, without, equations);
    add_surface(data.receptacle, Profile::even, 0.0, frame, without, equations);
    add_surface(data.adaxial, Profile::any, 0.0, frame, without, equations);
    add_surface(data.bowl, Profile::any, 0.5, frame, without, equations);
    return equations;
}

}  // namespace

std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& direction)
{
    const glm::dvec3 size = glm::abs(direction);
    const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1.0, 0.0, 0.0)
                             : size.y <= size.z                   ? glm::dvec3(0.0, 1.0, 0.0)
                                                                  : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 x = glm::normalize(other - direction * glm::dot(other, direction));
    return {x, glm::cross(direction, x)};
}

AxisFit refined_axis(const AxisData& data, HeadAxis axis, int without, int steps)
{
    AxisFit fit{.axis = axis};
    for (int step = 0; step < steps; ++step) {
        const Equations equations = equations_of(data, axis, without);
        const glm::dvec4 by = glm::inverse(equations.normal + glm::dmat4(1e-6)) * equations.right;
        const double size = glm::length(by);
        if (!(size < 1e6)) break;
        const double share = std::min(1.0, 0.3 / size);
        const auto [x, y] = across(axis.direction);
        axis.centre += share * (by.z * x + by.w * y);
        axis.direction = glm::normalize(axis.direction + share * (by.x * x + by.y * y));
        axis.centre -= axis.direction * glm::dot(axis.centre, axis.direction);
        if (size < 1e-9) break;
    }
    const Equations last = equations_of(data, axis, without);
    fit.axis = axis;
    fit.cost = last.cost;
    fit.information = last.normal;
    return fit;
}

}  // namespace shvr
