#pragma once
// Finds the nearest of many moving points, exactly. A balanced k-d tree (Bentley 1975) holds the points as of its last
// build; a list holds the points changed since. The list is searched linearly and stays below a 32nd of the tree's
// size, so queries between edits take microseconds, and rebuilding costs little per edit.
//
// One thread changes an index; any number of threads may query while no thread changes it. Copies share the tree.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

class TraceIndex {
public:
    /// Adds a point or moves it.
    void set(uint32_t number, const glm::dvec3& position);
    void erase(uint32_t number);

    /// The number of the nearest point; in a tie, the smallest number. Coordinates must be finite.
    std::optional<uint32_t> nearest(const glm::dvec3& position, std::optional<uint32_t> except = {}) const;
    /// The numbers of all points within `distance`, ascending.
    std::vector<uint32_t> within(const glm::dvec3& position, double distance) const;

private:
    struct Point {
        glm::dvec3 position;
        uint32_t number;
    };
    void note(uint32_t number, const std::optional<glm::dvec3>& position);
    void build();
    template <class Visit>
    void search(const glm::dvec3& position, const double& most_squared, const Visit& visit) const;

    struct Tree {
        std::vector<Point> points;  ///< k-d tree: the middle point of each range is its median along its longest axis
        std::vector<uint8_t> axes;  ///< the splitting axis of each
        void split(size_t begin, size_t end);
    };
    size_t tree_size() const { return tree_ ? tree_->points.size() : 0; }

    std::shared_ptr<const Tree> tree_;                       ///< shared with copies; null: empty
    std::map<uint32_t, std::optional<glm::dvec3>> changed_;  ///< changed since the tree was built; null: removed
};

}  // namespace shvr
