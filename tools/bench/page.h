#pragma once
// The bench's results for readers: one self-contained HTML page, and the plots as files.

#include "tools/bench/measure.h"
#include "tools/bench/sweeps.h"
#include "tools/report/plot.h"

namespace shvr::bench {

enum class Metric { rmse, flip };
/// Plots a scene's runs, error over milliseconds: one series per family, with labels on the qualities.
report::Plot plot_of(const SceneResult& scene, Metric metric);
/// Plots the errors of the qualities over the number of samples read: one series per scene.
report::Plot plot_of_qualities(const Results& results);
std::string page_of(const Results& results, const std::vector<Pictures>& pictures, const std::vector<Sweep>& sweeps);
/// Writes bench.json, bench.csv, front.csv, equal_error.csv, equal_time.csv, equal_peer.csv, pareto*.svg and .png,
/// insets.png, sweep-*.csv and .svg, report.html. Returns their paths.
std::vector<std::string> write_files(const Results& results, const std::vector<Pictures>& pictures,
                                     const std::vector<Sweep>& sweeps, const std::filesystem::path& output);
std::string text_of(const Comparison& comparison);

}  // namespace shvr::bench
