#pragma once
// Measures how much each golden varies with a driver's freedom: draws it on the same device with other vector widths,
// thread counts, instruction sets and poisoned memory. A class fits a golden if the class allows twice the spread.

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "tools/golden/run.h"

namespace shvr::golden {

/// An environment in which lavapipe runs; the first variant is the unchanged environment.
struct Variant {
    std::string name;
    std::vector<std::pair<std::string, std::string>> environment;
};
const std::vector<Variant>& variants();

/// Draws the goldens into `output`, also in linear light, in a process with the variant's environment. May throw.
using DrawAll = std::function<void(const Variant& variant, const std::filesystem::path& output)>;

/// The difference between a variant's picture and the first variant's.
struct Moved {
    PixelDifference pixels;  ///< in 8 bits, of 255
    double light = 0.0;      ///< maximum in linear light; above 0, the variant does change the arithmetic
};

struct Spread {
    Golden golden;
    std::optional<Maker> maker;  ///< the machine that drew the first variant
    std::map<std::string, Moved> by_variant;
    Moved most;                   ///< maximum of each metric
    bool holds = false;           ///< the class allows twice these differences
    bool could_be_exact = false;  ///< no variant changes an 8-bit picture
};
/// Pictures are left in `output`/VARIANT.
std::vector<Spread> calibrate(const std::vector<Golden>& goldens, const std::filesystem::path& output,
                              const DrawAll& draw_all);

/// Returns the spreads as a Markdown page for version control. `command`: the command that generates the page.
std::string table_of(const std::vector<Spread>& spreads, const std::string& command);

/// Whether `strictness` allows twice `most`.
bool allows_twice(const PixelDifference& most, Strictness strictness);

}  // namespace shvr::golden
