#include "engine/annotation/meshes/decimated_surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "engine/annotation/meshes/patch_decimation.h"
#include "engine/base/error.h"

namespace shvr {

/// The triangles of all groups, patch by patch.
class DecimatedSurfaces::Patches {
public:
    Patches(GroupSurfaces& surfaces, const DecimationOptions& options, std::array<Mesh, 256>& meshes)
        : options_(options), meshes_(meshes)
    {
        for (int group = 1; group < 256; ++group)
            if (surfaces.size_of(uint8_t(group)).triangles != 0) collect(surfaces, uint8_t(group));
    }

    /// Returns the largest error of a patch.
    double run()
    {
        double error = 0.0, done = 0.0, all = 0.0;
        for (const auto& [pair, triangles] : patches_) all += double(triangles.size());
        for (auto& [pair, triangles] : patches_) {
            const double share = double(triangles.size()) / all;
            const Progress progress = part_of(options_.progress, 0.3 + 0.7 * done, 0.3 + 0.7 * (done + share));
            error = std::max(error, run(pair, triangles, progress));
            done = std::min(done + share, 1.0);
            triangles = {};
        }
        return error;
    }

private:
    using Pair = std::pair<uint8_t, uint8_t>;  ///< a group, and a higher one or 0
    /// A triangle as vertices of the first group, and as those of the second, in the order of the first.
    struct Shared {
        glm::uvec3 of_first{0}, of_second{0};
    };

    void collect(GroupSurfaces& surfaces, uint8_t group)
    {
        tell(options_.progress, 0.3 * group / 256.0);
        Mesh& mesh = meshes_[group];
        surfaces.for_each_vertex(group, [&](const glm::dvec3& position) { mesh.vertices.push_back(position); });
        std::map<uint8_t, size_t> places;  // in the patches with lower groups
        double volume = 0.0;
        surfaces.for_each_border_triangle(group, [&](const glm::uvec3& t, uint8_t other) {
            const auto at = [&](uint32_t vertex) { return mesh.vertices[vertex] * options_.spacing; };
            volume += glm::dot(at(t.x), glm::cross(at(t.y), at(t.z))) / 6.0;
            if (other == 0 || other > group)
                patches_[{group, other}].push_back({.of_first = t});
            else
                patches_[{other, group}][places[other]++].of_second = {t.x, t.z, t.y};
        });
        slack_[group] = MAX_DECIMATION_CHANGE * std::abs(volume);
    }

    double run(const Pair& pair, const std::vector<Shared>& triangles, const Progress& progress)
    {
        // A vertex of the patch is one of each group, since a corner may be a vertex of the one and two of the other.
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> numbers;
        std::unordered_map<uint32_t, uint32_t> first_of_first, first_of_second;
        std::vector<std::pair<uint32_t, uint32_t>> vertices;
        Patch patch;
        for (const Shared& shared : triangles) {
            glm::uvec3 t(0);
            for (int corner = 0; corner < 3; ++corner) {
                const std::pair both(shared.of_first[corner], shared.of_second[corner]);
                const auto [found, is_new] = numbers.emplace(both, uint32_t(vertices.size()));
                if (is_new) {
                    vertices.push_back(both);
                    patch.same[0].push_back(first_of_first.emplace(both.first, found->second).first->second);
                    if (pair.second != 0)
                        patch.same[1].push_back(first_of_second.emplace(both.second, found->second).first->second);
                    patch.positions.push_back(meshes_[pair.first].vertices[both.first] * options_.spacing);
                }
                t[corner] = found->second;
            }
            patch.triangles.push_back(t);
        }
        numbers.clear();
        first_of_first = first_of_second = {};
        const std::vector<glm::dvec3> before = patch.positions;
        const double error = decimate(patch,
                                      {.triangles = size_t(std::ceil(options_.share * double(triangles.size()))),
                                       .error = std::min({options_.spacing.x, options_.spacing.y, options_.spacing.z}),
                                       .may_change = [&](double change) { return may_change(pair, change); }},
                                      progress);
        for (size_t i = 0; i < vertices.size(); ++i) {
            if (patch.positions[i] == before[i]) continue;
            const glm::dvec3 place = patch.positions[i] / options_.spacing;
            meshes_[pair.first].vertices[vertices[i].first] = place;
            if (pair.second != 0) meshes_[pair.second].vertices[vertices[i].second] = place;
        }
        for (const glm::uvec3& t : patch.triangles) {
            const auto [a, b, c] = std::array{vertices[t.x], vertices[t.y], vertices[t.z]};
            meshes_[pair.first].triangles.emplace_back(a.first, b.first, c.first);
            if (pair.second != 0) meshes_[pair.second].triangles.emplace_back(a.second, c.second, b.second);
        }
        return error;
    }

    bool may_change(const Pair& pair, double change)
    {
        const double first = changed_[pair.first] + change, second = changed_[pair.second] - change;
        if (std::abs(first) > slack_[pair.first] && std::abs(first) > std::abs(changed_[pair.first])) return false;
        if (pair.second != 0 && std::abs(second) > slack_[pair.second] &&
            std::abs(second) > std::abs(changed_[pair.second]))
            return false;
        changed_[pair.first] = first;
        changed_[pair.second] = second;
        return true;
    }

    const DecimationOptions& options_;
    std::array<Mesh, 256>& meshes_;
    std::map<Pair, std::vector<Shared>> patches_;
    std::array<double, 256> slack_{}, changed_{};  ///< volumes
};

namespace {

/// Fails if the triangles of all groups take more memory than there may be.
void check_memory(const GroupSurfaces& surfaces, uint64_t memory)
{
    uint64_t bytes = 0;
    for (int group = 1; group < 256; ++group) {
        const GroupSurfaces::Size& size = surfaces.size_of(uint8_t(group));
        bytes += size.vertices * sizeof(glm::dvec3) + size.triangles * (DECIMATION_BYTES_PER_TRIANGLE + 64);
    }
    if (memory != 0 && bytes > memory)
        fail("the surfaces take ", (bytes >> 20) + 1, " MiB of memory to be decimated; expected at most ", memory >> 20,
             " MiB, the budget of the host: use a larger --budget-host, or no --decimate");
}

}  // namespace

DecimatedSurfaces::DecimatedSurfaces(GroupSurfaces& surfaces, const DecimationOptions& options)
{
    check_memory(surfaces, options.memory);
    error_ = Patches(surfaces, options, meshes_).run();
    for (Mesh& mesh : meshes_) {
        // Without the vertices that are gone.
        std::vector<uint32_t> number(mesh.vertices.size(), UINT32_MAX);
        for (const glm::uvec3& t : mesh.triangles)
            for (int corner = 0; corner < 3; ++corner) number[t[corner]] = 0;
        uint32_t next = 0;
        for (size_t i = 0; i < number.size(); ++i) {
            if (number[i] == UINT32_MAX) continue;
            number[i] = next;
            mesh.vertices[next++] = mesh.vertices[i];
        }
        mesh.vertices.resize(next);
        mesh.vertices.shrink_to_fit();
        for (glm::uvec3& t : mesh.triangles) t = {number[t.x], number[t.y], number[t.z]};
    }
    tell(options.progress, 1.0);
}

GroupSurfaces::Size DecimatedSurfaces::size_of(uint8_t group) const
{
    return {meshes_[group].vertices.size(), meshes_[group].triangles.size()};
}

void DecimatedSurfaces::for_each_vertex(uint8_t group, const GroupSurfaces::VisitVertex& visit,
                                        const Progress& progress) const
{
    tell(progress, 0.0);
    for (const glm::dvec3& position : meshes_[group].vertices) visit(position);
}

void DecimatedSurfaces::for_each_triangle(uint8_t group, const GroupSurfaces::VisitTriangle& visit,
                                          const Progress& progress) const
{
    const Mesh& mesh = meshes_[group];
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (i % 65536 == 0) tell(progress, double(i) / double(mesh.triangles.size()));
        const glm::uvec3& t = mesh.triangles[i];
        visit(t, {mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
    }
}

}  // namespace shvr
