// How a simulated annotator paints: follows each segment of the plan with strokes until the segment looks painted.

#include <algorithm>
#include <cmath>

#include "engine/study/session.h"

namespace shvr {

namespace {

constexpr double GLANCE_M = 0.006;        ///< distance after which the eye checks the course again
constexpr double STROKE_M_PER_S = 0.008;  ///< slower than a reach, since the eye follows the probe
constexpr int TOOL_TICKS = 16;            ///< ticks per frame: a window extends a stroke at 60 frames a second
constexpr int STROKES = 3;                ///< at most, from one view
constexpr double LEFT_UNPAINTED = 0.06;   ///< share of the visible surface that an average annotator leaves unpainted
constexpr double EARLY = 0.7;             ///< share of a segment that is painted if painting stops early
constexpr double BACK_CHECKED = 0.5;      ///< share of segments whose back an average annotator checks

class PaintingSession final : public StudySession {
public:
    using StudySession::StudySession;

    void run() override
    {
        for (const PlannedSegment& planned : plan_segments(scene(), random_)) {
            if (desk_.is_over()) return;
            if (planned.is_adaxial && errs(Mistake::adaxial_unpainted)) continue;
            paint(planned);
        }
    }

private:
    void paint(const PlannedSegment& planned)
    {
        std::vector<glm::dvec3> course =
            points_along(course_of(scene(), planned), 0.5 * GLANCE_M * scene().voxels_per_metre());
        if (look_at(course, scene().vein_radius()) < SEEN_ENOUGH) {
            ++segments_unseen_;
            return;
        }
        if (errs(Mistake::stops_early)) course.resize(std::max<size_t>(size_t(EARLY * double(course.size())), 2));
        paint_visible(course, errs(Mistake::leaves_gaps));
        if (random_.happens(BACK_CHECKED / input_.skill.carelessness)) check_back(course);
        if (!planned.is_adaxial && errs(Mistake::receptacle)) paint_receptacle(course);
        if (errs(Mistake::wrong_bundle)) paint_wrong_bundle(course.back());
    }

    void paint_visible(const std::vector<glm::dvec3>& course, bool leaves_gaps)
    {
        for (int i = 0; i < STROKES && !desk_.is_over(); ++i) {
            think(times_.stroke);
            const std::vector<glm::dvec3> left = i == 0 ? course : unpainted_part(course);
            stroke(left, STUDY_THRESHOLD);
            if (leaves_gaps || unpainted_share(course) <= LEFT_UNPAINTED * input_.skill.carelessness) return;
        }
    }

    /// Looks at the segment from behind, and paints the parts that are unpainted there.
    void check_back(const std::vector<glm::dvec3>& course)
    {
        const glm::dvec3 front = view().to_eye;
        size_t back = view_;
        double least = 0.0;
        for (size_t i = 0; i < study_views().size(); ++i) {
            const double cosine = glm::dot(study_views()[i].to_eye, front);
            if (cosine >= least || sight_.visible_share(study_views()[i], course, scene().vein_radius()) < SEEN_ENOUGH)
                continue;
            least = cosine;
            back = i;
        }
        if (back == view_) return;
        change_view(back);
        if (unpainted_share(course) > LEFT_UNPAINTED * input_.skill.carelessness) paint_visible(course, false);
    }

    /// Moves the probe along the course, as the eye locates it, with the button pressed.
    void stroke(const std::vector<glm::dvec3>& course, double threshold)
    {
        const glm::dvec3 begin = seen(course.front());
        reach(begin);
        settle(begin);
        std::vector<glm::dvec3> path{desk_.tool()};
        desk_.spend(times_.key);
        const double per_tick = 0.001 * STROKE_M_PER_S * scene().voxels_per_metre();
        int ticks = 0;
        for (size_t i = 1; i < course.size() && !desk_.is_over(); ++i) {
            const glm::dvec3 from = aim_, to = seen(course[i]);
            const int steps = std::max(int(std::lround(glm::distance(from, to) / per_tick)), 1);
            for (int step = 1; step <= steps && !desk_.is_over(); ++step) {
                aim_ = glm::mix(from, to, double(step) / steps);
                const bool acts = ++ticks % TOOL_TICKS == 0;
                desk_.tick(aim_, 1000.0 * per_tick, acts);
                if (acts) path.push_back(desk_.tool());
            }
        }
        desk_.paint(std::move(path), threshold);
    }

    /// Calls `visit(place, is_painted)` for places on the part of the segment's surface that the view shows.
    template <class Visit>
    void each_visible_place(std::span<const glm::dvec3> course, const Visit& visit) const
    {
        constexpr double DEPTH = 0.7;  // fraction of the radius: points exactly on the surface may be outside the vein
        const double radius = DEPTH * scene().vein_radius();
        for (const glm::dvec3& at : course)
            for (const glm::dvec3& out : {view().to_eye, view().right, -view().right, view().up(), -view().up()}) {
                const Size3 voxel(glm::floor(at + radius * out));
                if (glm::any(glm::lessThan(voxel, Size3(0))) || glm::any(glm::greaterThanEqual(voxel, scene().size())))
                    continue;
                if (scene().intensity(voxel) < STUDY_THRESHOLD) continue;
                visit(at, desk_.document().mask.at(voxel) != 0);
            }
    }
    double unpainted_share(std::span<const glm::dvec3> course) const
    {
        double places = 0.0, unpainted = 0.0;
        each_visible_place(course, [&](const glm::dvec3&, bool is_painted) { ++places, unpainted += !is_painted; });
        return places > 0.0 ? unpainted / places : 0.0;
    }
    /// Returns the course from the first to the last place that looks unpainted; at least two places.
    std::vector<glm::dvec3> unpainted_part(const std::vector<glm::dvec3>& course) const
    {
        size_t first = course.size(), last = 0;
        for (size_t i = 0; i < course.size(); ++i)
            if (unpainted_share(std::span(course).subspan(i, 1)) > 0.0) first = std::min(first, i), last = i;
        if (first >= course.size()) return course;
        if (first == last) (last + 1 < course.size() ? ++last : --first);
        return {course.begin() + std::ptrdiff_t(first), course.begin() + std::ptrdiff_t(last + 1)};
    }

    /// Paints above the upper end of a floret's vein, with a threshold low enough to include receptacle tissue.
    void paint_receptacle(const std::vector<glm::dvec3>& course)
    {
        const glm::dvec3 top = course.front().z > course.back().z ? course.front() : course.back();
        const glm::dvec3 above = top + glm::dvec3(0.0, 0.0, 2.0 * scene().vein_radius());
        make_mistake(Mistake::receptacle, {top, above}, MISTAKEN_THRESHOLD);
    }

    void paint_wrong_bundle(const glm::dvec3& near)
    {
        const auto distance = [&](const SeparateBundle& bundle) {
            double least = glm::length(glm::dvec3(scene().size()));
            for (const glm::dvec3& at : bundle.course) least = std::min(least, glm::distance(at, near));
            return least;
        };
        const auto nearest = std::ranges::min_element(scene().separate_bundles(), {}, distance);
        if (nearest != scene().separate_bundles().end())
            make_mistake(Mistake::wrong_bundle, nearest->course, STUDY_THRESHOLD);
    }

    int64_t painted_voxels() const
    {
        const Size3 size = scene().size();
        return size.x * size.y * size.z - desk_.document().mask.voxels_by_group()[0];
    }

    void make_mistake(Mistake mistake, const std::vector<glm::dvec3>& course, double threshold)
    {
        if (desk_.is_over()) return;
        const int64_t before = painted_voxels();
        think(times_.stroke);
        stroke(course, threshold);
        if (painted_voxels() != before) notice(mistake, 1);
    }
};

}  // namespace

std::unique_ptr<StudySession> make_painting_session(const StudySessionInput& input)
{
    return std::make_unique<PaintingSession>(input);
}

}  // namespace shvr
