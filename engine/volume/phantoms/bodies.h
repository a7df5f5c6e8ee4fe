#pragma once
// Bodies around the tubes of interest, which no trace follows: stones, which are balls cut by planes, and bits of
// organic matter, which are tubes. Immutable; any thread may call it.

#include "engine/volume/phantoms/phantom_model.h"

namespace shvr {

/// Keeps the side of a plane on which the middle of the body's first end lies.
struct Facet {
    glm::dvec3 normal;  ///< unit vector, outwards
    double distance;    ///< voxels from the first end
};

class Bodies {
public:
    /// Each body's `Tube::tissue` is its group. `facets` of a body may be empty.
    Bodies(std::vector<Tube> bodies, std::vector<std::vector<Facet>> facets, const Size3& size, double blur);

    /// Returns the tissue at a position where `around` would be without bodies. The last body covers others.
    Tissue over(Tissue around, const glm::dvec3& voxel) const;

private:
    TubeScene scene_;
    std::vector<std::vector<Facet>> facets_;
    double blur_;
};

}  // namespace shvr
