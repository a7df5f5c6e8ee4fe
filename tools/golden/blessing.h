#pragma once
// Accepts ("blesses") a picture as correct: writes NAME.png and its side-car NAME.blessed.json, which records who drew
// it and why. No other code writes goldens.

#include <optional>
#include <span>
#include <string>

#include "tools/golden/studio.h"

namespace shvr::golden {

/// The machine that draws, as recorded in side-cars and reports.
struct Maker {
    std::string device, driver, processor;
    std::string instructions;  ///< instruction sets of the processor that change rounding: "avx2 fma"
};
/// Describes this machine.
Maker maker_of(Renderer& renderer);

/// Returns the kernels' counters (shaders/counters.h) by name, as spelled in side-cars and --json, summed over passes.
std::vector<std::pair<std::string, uint64_t>> work_of(std::span<const gpu::PassReport> passes);
/// Returns the exact work counters of a picture by name, summed over passes, and the numbers of passes and dispatches.
std::vector<std::pair<std::string, uint64_t>> counters_of(const Picture& picture);

/// The result of drawing.
struct Drawn {
    Image8 image;
    ImageF light;  ///< the same picture, before rounding to 8 bits
    Maker maker;
    std::vector<std::pair<std::string, uint64_t>> work;  ///< exact counters by name, summed over passes
    bool work_is_exact = true;                           ///< false: with paged bricks, counters depend on the disk
};
/// Draws the first picture of a studio, whose passes include preparation.
Drawn drawn_by(Studio& studio);

/// Returns why picture and side-car do not match, or which of them is missing; null if there is no such problem.
std::optional<std::string> why_not_blessed(const Golden& golden);
/// Returns a sentence with the counters that the side-car lacks, or for which it has another value; null if there are
/// none, or if bricks are paged. Differences do not count if another driver or another instruction set of the processor
/// drew the picture, since rays may then end a sample later.
std::optional<std::string> why_other_work(const Golden& golden, const Drawn& drawn);

struct Blessed {
    std::string name, old_hash, new_hash;   ///< "none", "unchanged"
    std::optional<PixelDifference> change;  ///< difference from the previous picture, if sizes are equal
};
/// Draws the golden and writes both files, unless picture, counters and class are unchanged. If the picture passes,
/// keeps the old one and renews only the side-car. Fails on any device but lavapipe, and if the environment variable CI
/// is set.
Blessed bless(const Golden& golden, const std::string& reason, const StudioOptions& options);

/// The command that accepts this golden.
std::string bless_command(const Golden& golden);

}  // namespace shvr::golden
