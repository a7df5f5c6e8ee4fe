#pragma once
// Accepting a picture as correct: NAME.png with its side-car NAME.blessed.json, which says who drew it and why. Nothing
// else writes goldens.

#include <optional>
#include <span>
#include <string>

#include "tools/golden/studio.h"

namespace shvr::golden {

/// Who draws: for side-cars and reports.
struct Maker {
    std::string device, driver, processor;
    std::string instructions;  ///< of the processor, those that change rounding: "avx2 fma"
};
/// Of this machine.
Maker maker_of(Renderer& renderer);

/// What kernels count (shaders/counters.h) by name, as side-cars and --json spell it, summed over passes.
std::vector<std::pair<std::string, uint64_t>> work_of(std::span<const gpu::PassReport> passes);
/// Exact work counters of a picture by name, summed over its passes, and how many passes and dispatches there were.
std::vector<std::pair<std::string, uint64_t>> counters_of(const Picture& picture);

/// What was drawn.
struct Drawn {
    Image8 image;
    ImageF light;  ///< the same, before it was rounded to 8 bits
    Maker maker;
    std::vector<std::pair<std::string, uint64_t>> work;  ///< exact counters by name, summed over passes
    bool work_is_exact = true;                           ///< false: paged, where counters depend on the disk
};
/// The first picture of a studio, whose passes also prepare.
Drawn drawn_by(Studio& studio);

/// Why picture and side-car do not belong together, or one is missing; null if all is well.
std::optional<std::string> why_not_blessed(const Golden& golden);
/// The counters that the side-car lacks, or that differ from its own, in a sentence; null where there are none: also
/// where bricks are paged, and of those that differ where another driver or another processor's instructions drew it
/// (rays may end a sample later).
std::optional<std::string> why_other_work(const Golden& golden, const Drawn& drawn);

struct Blessed {
    std::string name, old_hash, new_hash;   ///< "none", "unchanged"
    std::optional<PixelDifference> change;  ///< to the picture before, where sizes are equal
};
/// Draws and writes both files, unless picture, counters and class are what they were; a picture that passes is kept as
/// it is, and the side-car alone is renewed. Fails on any device but
/// lavapipe, and where the environment's CI is set.
Blessed bless(const Golden& golden, const std::string& reason, const StudioOptions& options);

/// The command that accepts it.
std::string bless_command(const Golden& golden);

}  // namespace shvr::golden
