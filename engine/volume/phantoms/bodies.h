#pragma once
// Bodies around the traced tubes: stones, which are balls cut by planes, and bits of organic matter, which are tubes.
// No trace includes bodies. Immutable; any thread may call it.

#include "engine/volume/phantoms/phantom_model.h"

namespace shvr {

/// A plane that cuts a body; the side with the centre of the body's first end stays.
struct Facet {
    glm::dvec3 normal;  ///< unit vector, outwards
    double distance;    ///< voxels from the first end
};

class Bodies {
public:
    /// `Tube::tissue` of a body is its group. `facets[i]` cut body i; may be empty.
    Bodies(std::vector<Tube> bodies, std::vector<std::vector<Facet>> facets, const Size3& size, double blur);

    /// Returns the tissue at a position; `around` is the tissue there without bodies. Later bodies cover earlier ones.
    Tissue over(Tissue around, const glm::dvec3& voxel) const;

private:
    TubeScene scene_;
    std::vector<std::vector<Facet>> facets_;
    double blur_;
};

}  // namespace shvr
