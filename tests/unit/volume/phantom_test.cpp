#include "engine/volume/phantoms/phantom.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <thread>

#include <doctest/doctest.h>

#include "engine/volume/procedural/tube_scene.h"
#include "engine/volume/procedural/turns.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

uint64_t phantom_hash(const std::vector<uint8_t>& bytes)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (const uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
    return hash;
}

PhantomSpec flawed(const std::string& kind, int64_t side)
{
    PhantomSpec spec{.kind = kind, .size = Size3(side), .seed = 3};
    spec.flaws = {.noise = 4, .rings = 10, .streaks = 20, .specks = 1, .gaps = 20, .falling = 30};
    return spec;
}

/// Voxels of balls of nodes, and of balls half-way along links, that the mask leaves out.
int64_t left_out(const Phantom& phantom)
{
    const Size3 size = phantom.mask->info().size;
    const std::vector<uint8_t> mask = voxels_of<uint8_t>(*phantom.mask);
    int64_t outside = 0;
    const auto count = [&](const glm::dvec3& centre, double radius) {
        const Size3 lower(glm::floor(centre - radius)), upper(glm::floor(centre + radius));
        for (int64_t z = lower.z; z <= upper.z; ++z)
            for (int64_t y = lower.y; y <= upper.y; ++y)
                for (int64_t x = lower.x; x <= upper.x; ++x) {
                    const glm::dvec3 d = glm::dvec3(x, y, z) + 0.5 - centre;
                    if (d.x * d.x + d.y * d.y + d.z * d.z > radius * radius) continue;
                    const bool is_inside = std::min({x, y, z}) >= 0 && x < size.x && y < size.y && z < size.z;
                    outside += !is_inside || mask[size_t(x + size.x * (y + size.y * z))] == 0;
                }
    };
    for (const auto& node : phantom.nodes) count(node.voxel, node.radius_voxels);
    for (const auto& [a, b] : phantom.links)
        count(0.5 * (phantom.nodes[a].voxel + phantom.nodes[b].voxel),
              0.5 * (phantom.nodes[a].radius_voxels + phantom.nodes[b].radius_voxels));
    return outside;
}

double resident_mib()
{
    std::ifstream file("/proc/self/statm");
    int64_t pages = 0, resident = 0;
    file >> pages >> resident;
    return double(resident) * double(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

}  // namespace

TEST_CASE("directions of turns are sine and cosine, exact at quarters")
{
    for (int i = -2000; i <= 2000; ++i) {
        const double turns = 0.00137 * i;
        const glm::dvec2 direction = direction_of(turns);
        CHECK(std::abs(direction.x - std::cos(2.0 * std::numbers::pi * turns)) < 4e-15);
        CHECK(std::abs(direction.y - std::sin(2.0 * std::numbers::pi * turns)) < 4e-15);
    }
    CHECK(direction_of(0.25) == glm::dvec2(0.0, 1.0));
    CHECK(direction_of(-0.5) == glm::dvec2(-1.0, 0.0));
    CHECK(direction_of(7.75) == glm::dvec2(0.0, -1.0));
}

TEST_CASE("the distance of a tube is that of the union of its balls")
{
    const Tube tubes[] = {{.ends = {glm::dvec3(2, 3, 4), glm::dvec3(9, 5, 8)}, .radii = {1.5, 3.0}},
                          {.ends = {glm::dvec3(2, 3, 4), glm::dvec3(9, 5, 8)}, .radii = {2.0, 2.0}},
                          {.ends = {glm::dvec3(2, 3, 4), glm::dvec3(3, 3, 4)}, .radii = {1.0, 4.0}},
                          {.ends = {glm::dvec3(5, 5, 5), glm::dvec3(5, 5, 5)}, .radii = {2.0, 2.0}}};
    for (const Tube& tube : tubes)
        for (int i = 0; i < 300; ++i) {
            const glm::dvec3 p(i % 7 * 2.1 - 1.0, i / 7 % 7 * 1.9 - 1.0, i / 49 * 2.0 - 1.0);
            double least = 1e9;
            for (int k = 0; k <= 20000; ++k) {
                const double t = k / 20000.0;
                least = std::min(least, glm::length(p - glm::mix(tube.ends[0], tube.ends[1], t)) -
                                            (1.0 - t) * tube.radii[0] - t * tube.radii[1]);
            }
            CHECK(std::abs(distance_from(tube, p).voxels - least) < 1e-6);
        }
}

TEST_CASE("a scene finds every tube that is near, and the group of the deepest")
{
    std::vector<Tube> tubes;
    for (int i = 0; i < 40; ++i) {
        const auto place = [&](int k) { return glm::dvec3(i * 37 % 61 + k, i * 23 % 57 - 2 * k, i * 11 % 67 + k); };
        tubes.push_back({.ends = {place(0), place(9)}, .radii = {1.0 + i % 3, 2.0}, .group = uint8_t(i % 4)});
    }
    const Size3 size(60, 50, 70);
    const TubeScene scene(tubes, size, 1.5);
    for (int64_t z = -4; z < size.z + 4; z += 3)
        for (int64_t y = -4; y < size.y + 4; y += 3)
            for (int64_t x = -4; x < size.x + 4; x += 3) {
                const glm::dvec3 p = glm::dvec3(x, y, z) + 0.5;
                const auto near = scene.near(p);
                const bool is_inside = std::min({x, y, z}) >= 0 && x < size.x && y < size.y && z < size.z;
                double deepest = 1e-6;
                uint8_t group = 0;
                for (uint32_t i = 0; i < tubes.size(); ++i) {
                    const double distance = distance_from(tubes[i], p).voxels;
                    if (is_inside && distance <= 1.5) CHECK(std::ranges::find(near, i) != near.end());
                    if (tubes[i].group == 0 || distance > deepest || (group != 0 && distance == deepest)) continue;
                    deepest = distance;
                    group = tubes[i].group;
                }
                if (is_inside) CHECK(scene.group(p) == group);
            }
}

TEST_CASE("the graph of a phantom lies in its mask to the last voxel")
{
    for (const std::string kind : {"capitulum", "roots", "stem", "helix", "tubes", "speckles"})
        for (const int64_t side : {7, 33, 48}) {
            CAPTURE(kind);
            CAPTURE(side);
            const Phantom phantom = make_phantom({.kind = kind, .size = Size3(side), .seed = uint32_t(side)});
            if (!has_flaws(kind) || side > 16) CHECK(left_out(phantom) == 0);
            CHECK((side < 16 || phantom.nodes.size() > 8));
            for (const auto& node : phantom.nodes) CHECK(node.group != 0);
            CHECK(!phantom.sections.empty());
        }
}

TEST_CASE("a phantom's voxels do not depend on the box that is read")
{
    for (const char* kind : {"capitulum", "section", "roots", "stem", "helix"}) {
        CAPTURE(kind);
        const Phantom phantom = make_phantom(flawed(kind, 40));
        for (const VolumeSource* source : {phantom.volume.get(), phantom.mask.get(), phantom.tissue_mask.get()}) {
            if (!source) continue;
            const std::vector<uint8_t> all = voxels_of<uint8_t>(*source);
            const VoxelBox box{{5, 17, 12}, {33, 36, 29}};
            const std::vector<uint8_t> part = voxels_in<uint8_t>(*source, box);
            size_t at = 0;
            int64_t different = 0;
            for (int64_t z = box.lower.z; z < box.upper.z; ++z)
                for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                    for (int64_t x = box.lower.x; x < box.upper.x; ++x)
                        different += part[at++] != all[size_t(x + 40 * (y + 40 * z))];
            CHECK(different == 0);
        }
    }
}

// Kind (phantoms): a phantom of 4096^3 voxels, 64 GiB as bytes
TEST_CASE("a box of a phantom of 4096 voxels a side is read by itself, in little memory")
{
    for (const char* kind : {"capitulum", "section", "roots", "stem", "helix", "tubes", "speckles"}) {
        CAPTURE(kind);
        const bool is_plant = has_flaws(kind);
        PhantomSpec spec = is_plant ? flawed(kind, 4096) : PhantomSpec{.kind = kind, .size = Size3(4096)};
        spec.type = VoxelType::uint16;
        const double before = resident_mib();
        const Phantom phantom = make_phantom(spec);
        std::vector<Size3> places{Size3(4), Size3(2048), Size3(4091)};
        REQUIRE(phantom.nodes.empty() == (std::string(kind) == "speckles"));  // too many for a trace
        if (!phantom.nodes.empty()) {
            places.clear();
            for (const size_t i : {size_t{0}, phantom.nodes.size() / 2, phantom.nodes.size() - 1})
                places.emplace_back(glm::floor(phantom.nodes[i].voxel));
        }
        for (const Size3& at : places) {
            const VoxelBox box{at - Size3(4), at + Size3(4)};
            const std::vector<uint16_t> voxels = voxels_in<uint16_t>(*phantom.volume, box);
            CHECK(voxels.back() > 0);
            CHECK(voxels_in<uint16_t>(*phantom.volume, {at + Size3(3), at + Size3(4)}).front() == voxels.back());
            for (const VolumeSource* mask :
                 {phantom.mask.get(), phantom.partial_mask.get(), phantom.tissue_mask.get()}) {
                if (!mask) continue;
                const std::vector<uint8_t> groups = voxels_in<uint8_t>(*mask, box);
                CHECK(voxels_in<uint8_t>(*mask, {at + Size3(3), at + Size3(4)}).front() == groups.back());
                // Structures grow with the size: the box lies in the vein around its node.
                if (is_plant) CHECK(std::ranges::count(groups, 0) == (mask == phantom.tissue_mask.get() ? 512 : 0));
            }
        }
        CHECK(resident_mib() - before < 48.0);
    }
}

TEST_CASE("16 bits hold a phantom's intensities a hundredfold")
{
    PhantomSpec spec = flawed("capitulum", 24);
    const std::vector<uint8_t> bytes = voxels_of<uint8_t>(*make_phantom(spec).volume);
    spec.type = VoxelType::int8;
    const std::vector<int8_t> lowered = voxels_of<int8_t>(*make_phantom(spec).volume);
    spec.type = VoxelType::uint16;
    const std::vector<uint16_t> words = voxels_of<uint16_t>(*make_phantom(spec).volume);
    int64_t wrong = 0;
    for (size_t i = 0; i < bytes.size(); ++i)
        wrong += bytes[i] != (words[i] + 50) / 100 || int(bytes[i]) != int(lowered[i]) + 128;
    CHECK(wrong <= int64_t(bytes.size() / 100));  // both are rounded once, so that halves differ
}

TEST_CASE("flaws are as strong as they are said to be")
{
    // No head: noise, rings and streaks alone, in air.
    const auto of = [](const PhantomFlaws& flaws) {
        return voxels_of<double>(
            *make_phantom({.kind = "capitulum", .size = {64, 64, 64}, .type = VoxelType::float64, .flaws = flaws})
                 .volume);
    };
    const std::vector<double> plain = of({.noise = 0});
    const std::vector<double> noisy = of({.noise = 5}), ringed = of({.noise = 0, .rings = 10});
    const std::vector<double> specked = of({.noise = 0, .specks = 2}), fallen = of({.noise = 0, .falling = 40});
    const std::vector<double> streaked = of({.noise = 0, .streaks = 10}), uneven = of({.noise = 0, .uneven = 25});
    double squares = 0.0, ring = 0.0, streak = 0.0;
    double weakest = 1.0, strongest = 1.0;
    int64_t specks = 0, higher = 0;
    for (size_t i = 0; i < plain.size(); ++i) {
        squares += (noisy[i] - plain[i]) * (noisy[i] - plain[i]);
        ring = std::max(ring, std::abs(ringed[i] - plain[i]));
        streak = std::max(streak, std::abs(streaked[i] - plain[i]));
        specks += plain[i] < 3000.0 && specked[i] > 13000.0;
        higher += fallen[i] > plain[i];
        weakest = std::min(weakest, uneven[i] / plain[i]);
        strongest = std::max(strongest, uneven[i] / plain[i]);
    }
    // 140 intensities between ground tissue and veins, a hundredfold.
    CHECK(std::sqrt(squares / double(plain.size())) == doctest::Approx(0.05 * 14000.0).epsilon(0.03));
    CHECK(ring <= 1400.0);
    CHECK(ring > 1000.0);
    CHECK(streak <= 2800.0);
    CHECK(streak > 700.0);
    CHECK(double(specks) / double(plain.size()) == doctest::Approx(0.02).epsilon(0.5));
    CHECK(higher == 0);
    CHECK(weakest >= 0.75);
    CHECK(weakest < 0.85);
    CHECK(strongest <= 1.25);
    CHECK(strongest > 1.15);
    const size_t axis = 32 + 64 * (32 + 64 * 34), corner = 64 * 64 * 40;
    CHECK(fallen[axis] == doctest::Approx(0.6 * plain[axis]).epsilon(0.01));
    CHECK(fallen[corner] == plain[corner]);
}

TEST_CASE("equal seeds give equal phantoms, on every machine")
{
    for (const auto& [kind, hash] : {std::pair("capitulum", 7487070715744241946u),
                                     {"section", 6756486309683975201u},
                                     {"roots", 13156248725099988103u},
                                     {"stem", 2012790638558495900u},
                                     {"helix", 11022273045698976639u}}) {
        CAPTURE(kind);
        PhantomSpec spec = flawed(kind, 40);
        spec.flaws.uneven = std::string(kind) == "capitulum" ? 0.0 : 20.0;
        const std::vector<uint8_t> once = voxels_of<uint8_t>(*make_phantom(spec).volume);
        CHECK(once == voxels_of<uint8_t>(*make_phantom(spec).volume));
        CHECK(phantom_hash(once) == hash);
        spec.seed = 4;
        CHECK(once != voxels_of<uint8_t>(*make_phantom(spec).volume));
    }
}

TEST_CASE("threads that read one phantom at the same time get the voxels that one thread gets")
{
    const Phantom phantom = make_phantom(flawed("roots", 40));
    const std::vector<uint8_t> once = voxels_of<uint8_t>(*phantom.volume);
    std::vector<uint8_t> together(once.size());
    std::vector<std::jthread> threads;
    for (int64_t i = 0; i < 4; ++i)
        threads.emplace_back([&, i] {
            phantom.volume->read({{0, 0, 10 * i}, {40, 40, 10 * i + 10}},
                                 std::as_writable_bytes(std::span(together).subspan(size_t(16000 * i), 16000)));
        });
    threads.clear();
    CHECK(together == once);
}

TEST_CASE("a phantom that cannot be is refused in words")
{
    const auto refusal = [](auto change) {
        PhantomSpec spec{.size = Size3(8)};
        change(spec);
        return error_of([&] { make_phantom(spec); });
    };
    CHECK(refusal([](PhantomSpec& spec) { spec.flaws.specks = 5; }) == "capitulum: specks is 5; expected 0 to 4");
    CHECK(refusal([](PhantomSpec& spec) { spec.flaws.blur = 0; }) == "capitulum: blur is 0; expected 0.01 to 16");
    CHECK(refusal([](PhantomSpec& spec) { spec.florets = 3; }) == "capitulum: florets is 3; expected 8 to 1000");
    CHECK(refusal([](PhantomSpec& spec) { spec.species = "rosa"; }) ==
          "species is \"rosa\"; expected gerbera, helianthus or bellis");
    CHECK(refusal([](PhantomSpec& spec) { spec.stage = "e"; }) == "stage is \"e\"; expected a, b, c or d");
    CHECK(refusal([](PhantomSpec& spec) { spec.phyllotaxis = "whorled"; }) ==
          "phyllotaxis is \"whorled\"; expected fibonacci, lucas or bijugate");
}
