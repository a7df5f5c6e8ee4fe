// Times an idle iteration of the workbench, one action of settings, and the snapshot of a save, on a scan of 512^3:
//
//   cmake --build build/release --target bench_workbench

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>

#include "engine/workbench/edits/edit.h"
#include "engine/workbench/workbench.h"

namespace {

using namespace shvr;

double seconds()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Median of `times` runs, in microseconds.
template <class Run>
double median_us(int times, Run run)
{
    std::vector<double> taken;
    for (int i = 0; i < times; ++i) {
        const double begin = seconds();
        run();
        taken.push_back((seconds() - begin) * 1e6);
    }
    std::ranges::nth_element(taken, taken.begin() + times / 2);
    return taken[size_t(times / 2)];
}

}  // namespace

int main()
{
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "shvr_workbench_bench";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "scan.json") << R"({"shvr_session": 1,
        "volume": {"procedural": "tubes", "size": [512, 512, 512]},
        "groups": {"1": {"name": "one"}, "2": {"name": "two", "parent": 1}, "3": {"color": "#20b060"}}})";
    Renderer renderer({});
    ui::Workbench bench(renderer, {.has_servo = false});
    bench.set_pixels({640, 480});
    bench.open(folder / "scan.json", {});
    while (bench.has_work()) bench.advance();
    for (int node = 0; node < 1000; ++node)
        bench.perform(NodeOp{.at = {double(node % 500), 250.0, 250.0}, .radius_voxels = 1.0, .group = uint8_t{2}});
    while (bench.has_work()) bench.advance();
    std::printf("a turn: %.1f us\n", median_us(10000, [&] { bench.advance(); }));
    std::printf("a model: %.1f us\n", median_us(10000, [&] { static_cast<void>(bench.model().undoable); }));
    double ambient = 0.0;
    std::printf("a setting: %.1f us\n", median_us(1000, [&] {
                    ambient = ambient > 0.9 ? 0.0 : ambient + 0.001;
                    bench.perform(ui::edited(bench.model().session, [&](Session& s) { s.light.ambient = ambient; }));
                }));
    // The copy of the work for a save or a job, which shares bricks and pages of the trace.
    for (int node = 1000; node < 100'000; ++node)
        bench.perform(NodeOp{.at = {double(node % 500), double(node / 500), 250.0}, .radius_voxels = 1.0});
    while (bench.has_work()) bench.advance();
    const Document& work = bench.document().annotator.document();
    std::printf("a snapshot of %zu nodes: %.1f us\n", work.trace.nodes().size(),
                median_us(100, [&] { const Document snapshot = work; }));
    std::filesystem::remove_all(folder);
}
