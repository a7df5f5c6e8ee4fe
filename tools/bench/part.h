#pragma once
// The measurements of a task of `shvr bench`, in a file, and the joining of all tasks. One task measures a scene or a
// sweep whole, so that its times are of one machine.

#include "tools/bench/measure.h"
#include "tools/bench/sweeps.h"

namespace shvr::bench {

struct Part {
    Results results;  ///< with the scenes that the task measured
    std::vector<Pictures> pictures;
    std::vector<Sweep> sweeps;
};

/// Replaces the file atomically.
void write_part(const Part& part, const std::filesystem::path& file);
/// Fails with a sentence if the file is not what write_part writes. Sweeps have their finished plot and table.
Part read_part(const std::filesystem::path& file);
/// Joins the parts of tasks, of which task I measured scenes and sweeps I, I + N, I + 2 N, ... Adds a sentence to
/// `left_out` for each task that ran on another processor or device.
Part joined(std::vector<Part> parts);

}  // namespace shvr::bench
