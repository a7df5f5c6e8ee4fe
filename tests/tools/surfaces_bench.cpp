// Cost of drawing 10,000 rods by the number of rods in a leaf of the hierarchy, and with every rod tested (takes a
// minute).
//
//   cmake --build build/release --target bench_surfaces

#include <chrono>
#include <cstdio>
#include <ctime>
#include <random>

#include "engine/device/surfaces.h"
#include "engine/gpu/executor.h"
#include "engine/passes/surfaces.h"

using namespace shvr;

namespace {

constexpr glm::uvec2 PIXELS(512);

struct Dice {
    std::mt19937 random;
    double operator()(double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; }
    glm::dvec3 point(double low, double high) { return {(*this)(low, high), (*this)(low, high), (*this)(low, high)}; }
};

std::vector<SurfaceLook> random_rods(size_t count)
{
    Dice dice{std::mt19937(96)};
    std::vector<SurfaceLook> rods(count);
    for (SurfaceLook& rod : rods) {
        rod.from = dice.point(10.0, 90.0);
        rod.to = rod.from + dice.point(-6.0, 6.0);
        rod.radius_from = dice(0.012, 0.6);
        rod.radius_to = dice(0.012, 0.6);
    }
    return rods;
}

class Bench {
public:
    void measure(const std::vector<SurfaceLook>& rods, size_t leaf)
    {
        draw(rods, leaf);  // makes the pipeline, and the memory that is used again
        const std::clock_t begun = std::clock();
        const double wall_ms = draw(rods, leaf);
        const double cpu_ms = 1e3 * double(std::clock() - begun) / CLOCKS_PER_SEC;
        std::printf("%6zu rods, %5zu in a leaf: %8.2f ms, %8.2f ms of all cores\n", rods.size(), leaf, wall_ms, cpu_ms);
    }

private:
    double draw(const std::vector<SurfaceLook>& rods, size_t leaf)
    {
        VolumeInfo info;
        info.size = Size3(100);
        const Camera camera{.eye = {-150, -60, 90}, .target = glm::dvec3(50.0), .fov_y_degrees = 30.0};
        SurfaceScene scene(memory_);
        scene.set(SurfaceForest(keyed(rods), info, leaf));
        FrameGraph graph;
        SurfacesInput input{.params = {},
                            .scene = scene.params(ray_planes(camera, PIXELS, info), PIXELS, info),
                            .listed = scene.upload(graph),
                            .tile = {128, 128}};
        input.params.pixel_end = PIXELS;
        input.params.light = {0.0f, 0.0f, 1.0f};
        input.params.diffuse = 1.0f;
        input.params.inverse_spacing = glm::vec3(1.0f);
        graph.read_back(surfaces(graph, input));
        const auto begun = std::chrono::steady_clock::now();
        executor_.run(std::move(graph));
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
    }

    gpu::Device device_;
    gpu::Memory memory_{device_};
    gpu::Executor executor_{device_, memory_};
};

}  // namespace

int main()
{
    try {
        const std::vector<SurfaceLook> rods = random_rods(10000);
        Bench bench;
        bench.measure({rods[0]}, gpu::SURFACES_IN_LEAF);
        for (const size_t leaf : {1, 2, 4, 8}) bench.measure(rods, leaf);
        bench.measure(rods, rods.size());
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
