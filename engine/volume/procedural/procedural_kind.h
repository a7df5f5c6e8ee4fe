#pragma once
// The interface of a kind of procedural volume, for source_procedural.cpp. Values are 0 ... 250 and depend only on the
// parameters. Kinds are immutable, and any thread may call them. A `Rows` object belongs to one thread.

#include <memory>
#include <optional>
#include <span>

#include "engine/volume/procedural/source_procedural.h"

namespace shvr {

class ProceduralKind {
public:
    virtual ~ProceduralKind() = default;

    virtual double value(const glm::dvec3& voxel) const = 0;
    virtual bool has_gradient() const { return true; }
    virtual glm::dvec3 gradient(const glm::dvec3& voxel) const = 0;
    virtual std::optional<ProceduralTruth> truth() const { return std::nullopt; }

    /// Evaluates rows of a box; fastest if z varies faster than y. A value equals, bit for bit, the result of `value`
    /// at the voxel's centre.
    class Rows {
    public:
        virtual ~Rows() = default;
        virtual void evaluate(int64_t y, int64_t z, std::span<double> values) = 0;
    };
    virtual std::unique_ptr<Rows> rows(const VoxelBox& box) const;
    /// Returns the rows of a coarser level, whose voxels span `side` voxels of a volume of `size` voxels along each
    /// axis. `box`, y and z count voxels of the coarser level. Values are those at voxel centres, except for features
    /// thinner than a voxel (ProceduralSpec).
    virtual std::unique_ptr<Rows> coarse_rows(double side, const Size3& size, const VoxelBox& box) const;
};

std::unique_ptr<ProceduralKind> make_constant(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_ramp(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_sphere(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_marschner_lobb(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_tubes(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_speckles(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_fog(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_checker(const Size3& size, uint32_t seed);
std::unique_ptr<ProceduralKind> make_chirality(const Size3& size, uint32_t seed);

}  // namespace shvr
