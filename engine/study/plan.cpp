#include "engine/study/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace shvr {

namespace {

constexpr uint8_t ADAXIAL_GROUP = 2;  // of the phantom `section`

class Planner {
public:
    Planner(const StudyScene& scene, StudyRandom& random) : scene_(scene), random_(random)
    {
        for (size_t i = 0; i < scene.segments().size(); ++i) left_.insert(i);
    }

    std::vector<PlannedSegment> plan()
    {
        std::vector<PlannedSegment> planned;
        while (!left_.empty()) {
            planned.push_back(next());
            left_.erase(planned.back().segment);
            reached_.insert(planned.back().nodes.begin(), planned.back().nodes.end());
            at_ = scene_.trace().node(planned.back().nodes.back()).position;
        }
        return planned;
    }

private:
    bool is_adaxial(size_t segment) const
    {
        const std::vector<uint32_t>& nodes = scene_.segments()[segment].nodes;
        return std::ranges::all_of(nodes, [&](uint32_t n) { return scene_.trace().node(n).group == ADAXIAL_GROUP; });
    }
    bool is_end(uint32_t node) const { return scene_.trace().internodes_of(node).size() == 1; }

    /// Returns the cost of continuing with a segment from its node `from`; the segment with the lowest cost comes next.
    double cost(size_t segment, uint32_t from) const
    {
        const double side = double(scene_.spec().side);
        double cost = is_adaxial(segment) ? 0.0 : 0.25;  // of the side
        if (reached_.empty()) return is_end(from) && is_adaxial(segment) ? 0.0 : std::numeric_limits<double>::max();
        if (!reached_.contains(from)) return std::numeric_limits<double>::max();
        return cost + glm::distance(scene_.trace().node(from).position, at_) / side;
    }

    PlannedSegment next()
    {
        PlannedSegment best;
        double least = std::numeric_limits<double>::infinity();
        for (const size_t segment : left_)
            for (const bool is_reversed : {false, true}) {
                std::vector<uint32_t> nodes = scene_.segments()[segment].nodes;
                if (is_reversed) std::ranges::reverse(nodes);
                const double price = cost(segment, nodes.front()) + 0.05 * random_.unit();
                if (price >= least) continue;
                least = price;
                best = {segment, std::move(nodes), is_adaxial(segment)};
            }
        return best;
    }

    const StudyScene& scene_;
    StudyRandom& random_;
    std::set<size_t> left_;
    std::set<uint32_t> reached_;
    glm::dvec3 at_{0.0};
};

}  // namespace

std::vector<PlannedSegment> plan_segments(const StudyScene& scene, StudyRandom& random)
{
    return Planner(scene, random).plan();
}

std::vector<glm::dvec3> points_along(std::span<const glm::dvec3> course, double spacing)
{
    double length = 0.0;
    for (size_t i = 1; i < course.size(); ++i) length += glm::distance(course[i - 1], course[i]);
    const int pieces = std::max(int(std::lround(length / spacing)), 1);
    std::vector<glm::dvec3> points{course.front()};
    double way = 0.0;
    for (size_t i = 1; i < course.size(); ++i) {
        const double piece = glm::distance(course[i - 1], course[i]);
        while (int(points.size()) < pieces && double(points.size()) * length / pieces <= way + piece)
            points.push_back(
                glm::mix(course[i - 1], course[i], (double(points.size()) * length / pieces - way) / piece));
        way += piece;
    }
    points.push_back(course.back());
    return points;
}

std::vector<glm::dvec3> course_of(const StudyScene& scene, const PlannedSegment& planned)
{
    std::vector<glm::dvec3> course;
    for (const uint32_t node : planned.nodes) course.push_back(scene.trace().node(node).position);
    return course;
}

}  // namespace shvr
