#pragma once
// Eigenvectors of symmetric 3x3 matrices, and moments of weighted straight pieces. Pure functions.

#include <array>
#include <cmath>

#include <glm/glm.hpp>

namespace shvr {

struct Eigen {
    std::array<double, 3> values;  ///< ascending
    std::array<glm::dvec3, 3> vectors;
};

/// By Jacobi's rotations, to the last bits.
inline Eigen eigen_of(glm::dmat3 matrix)
{
    glm::dmat3 vectors(1.0);
    for (int sweep = 0; sweep < 40; ++sweep)
        for (const auto& [p, q] : {std::pair(0, 1), {0, 2}, {1, 2}}) {
            if (matrix[p][q] == 0.0) continue;
            const double theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
            const double t = (theta < 0.0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
            const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
            glm::dmat3 rotation(1.0);
            rotation[p][p] = rotation[q][q] = c;
            rotation[q][p] = s;
            rotation[p][q] = -s;
            matrix = glm::transpose(rotation) * matrix * rotation;
            matrix[p][q] = matrix[q][p] = 0.0;
            vectors = vectors * rotation;
        }
    std::array<int, 3> order{0, 1, 2};
    for (int pass = 0; pass < 2; ++pass)
        for (size_t i = 0; i < 2; ++i)
            if (matrix[order[i]][order[i]] > matrix[order[i + 1]][order[i + 1]]) std::swap(order[i], order[i + 1]);
    Eigen eigen{};
    for (size_t i = 0; i < 3; ++i) {
        eigen.values[i] = matrix[order[i]][order[i]];
        eigen.vectors[i] = vectors[order[i]];
    }
    return eigen;
}

/// Mean and covariance of straight pieces; the weight of each piece is spread evenly along it.
class Moments {
public:
    void add(const glm::dvec3& a, const glm::dvec3& b, double weight)
    {
        const glm::dvec3 middle = 0.5 * (a + b);
        weight_ += weight;
        sum_ += weight * middle;
        // Simpson's rule is exact for squares.
        squares_ += weight / 6.0 * (glm::outerProduct(a, a) + glm::outerProduct(b, b)) +
                    weight * 4.0 / 6.0 * glm::outerProduct(middle, middle);
    }
    double weight() const { return weight_; }
    glm::dvec3 mean() const { return sum_ / weight_; }
    glm::dmat3 covariance() const { return squares_ / weight_ - glm::outerProduct(mean(), mean()); }

private:
    double weight_ = 0.0;
    glm::dvec3 sum_{0.0};
    glm::dmat3 squares_{0.0};
};

}  // namespace shvr
