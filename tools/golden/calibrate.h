#pragma once
// How far a driver's own freedom moves each golden: the same pictures on the same device with other vector widths,
// thread counts, instruction sets and poisoned memory. A class is right where it allows twice the spread.

#include <functional>
#include <map>

#include "tools/golden/golden.h"

namespace shvr::golden {

/// A way to run lavapipe; the first of them changes nothing.
struct Variant {
    std::string name;
    std::vector<std::pair<std::string, std::string>> environment;
};
const std::vector<Variant>& variants();

/// Draws the goldens into `output` in a process with that environment. Throws where it could not.
using DrawAll = std::function<void(const Variant& variant, const std::filesystem::path& output)>;

struct Spread {
    Golden golden;
    std::map<std::string, PixelDifference> by_variant;  ///< to the first variant's picture
    PixelDifference most;                               ///< of each metric
    bool holds = false;                                 ///< the class allows twice as much
    bool could_be_exact = false;                        ///< no variant changes a bit
};
/// Pictures are left in `output`/VARIANT.
std::vector<Spread> calibrate(const std::vector<Golden>& goldens, const std::filesystem::path& output,
                              const DrawAll& draw_all);

/// Whether `strictness` allows twice `most`.
bool allows_twice(const PixelDifference& most, Strictness strictness);

}  // namespace shvr::golden
