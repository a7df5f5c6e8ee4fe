#pragma once
// The arrays of a glTF file, whose elements refer to each other by number. One thread.

#include <optional>
#include <utility>
#include <vector>

#include "engine/formats/meshes/glb_content.h"

namespace shvr {

/// An array at the top of the document; empty if it is missing.
class GlbTable {
public:
    GlbTable(const JsonNode& root, const char* name);
    size_t size() const { return elements_.size(); }
    const JsonNode& operator[](size_t number) const { return elements_[number]; }
    /// The number that a value states.
    size_t number_in(const JsonNode& reference) const;
    const JsonNode& at(const JsonNode& reference) const { return elements_[number_in(reference)]; }

private:
    const char* name_;
    std::vector<JsonNode> elements_;
};

/// The accessors of a file, checked as they are asked for.
class GlbAccessors {
public:
    GlbAccessors(const JsonNode& root, const GlbBinary& binary);
    /// Three floats for each point.
    GlbAccessor positions(const JsonNode& reference) const;
    /// A whole number for each corner.
    GlbAccessor indices(const JsonNode& reference) const;

private:
    GlbAccessor placed(const JsonNode& reference, uint64_t component_bytes, uint64_t components) const;

    GlbTable accessors_, views_, buffers_;
    GlbBinary binary_;
};

/// The transform of a node relative to its parent: a matrix, or translation, rotation and scale.
glm::dmat4 transform_of(const JsonNode& node);

}  // namespace shvr
