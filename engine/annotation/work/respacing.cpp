#include "engine/annotation/work/respacing.h"

#include <optional>

#include "engine/base/error.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

class Respacing {
public:
    Respacing(const glm::dvec3& from, const glm::dvec3& to) : from_(from), to_(to) {}

    void operator()(double& radius) const { radius = radius / from_.x * to_.x; }
    void operator()(TraceNode& node) const
    {
        node.position = node.position / from_ * to_;
        (*this)(node.radius);
    }
    template <class Value>
    void operator()(std::optional<Value>& value) const
    {
        if (value) (*this)(*value);
    }
    void operator()(TraceNodeChange& change) const { both(change); }
    void operator()(TraceSizeChange& change) const { both(change); }
    void operator()(TraceInternodeChange&) const {}
    void operator()(TraceSelectionChange&) const {}

private:
    template <class Record>
    void both(Record& change) const
    {
        (*this)(change.before);
        (*this)(change.after);
    }
    glm::dvec3 from_, to_;
};

}  // namespace

std::string in_words(const JournalSpace& space)
{
    return spacing_in_words(space.spacing, space.unit);
}

bool is_same_spacing(const glm::dvec3& one, const glm::dvec3& other)
{
    constexpr double TOLERANCE = 1e-8;
    return glm::all(glm::lessThanEqual(glm::abs(one - other), TOLERANCE * glm::abs(other)));
}

void respace(Change& change, const glm::dvec3& from, const glm::dvec3& to)
{
    if (auto* const trace = std::get_if<TraceChange>(&change)) std::visit(Respacing(from, to), *trace);
}

}  // namespace shvr
