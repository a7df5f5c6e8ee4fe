#pragma once
// How far a driver's own freedom moves each golden: the same pictures on the same device with other vector widths,
// thread counts, instruction sets and poisoned memory. A class is right where it allows twice the spread.

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "tools/golden/run.h"

namespace shvr::golden {

/// A way to run lavapipe; the first of them changes nothing.
struct Variant {
    std::string name;
    std::vector<std::pair<std::string, std::string>> environment;
};
const std::vector<Variant>& variants();

/// Draws the goldens into `output`, in linear light, too, in a process with that environment. Throws where it cannot.
using DrawAll = std::function<void(const Variant& variant, const std::filesystem::path& output)>;

/// How far a picture is from the first variant's.
struct Moved {
    PixelDifference pixels;  ///< in 8 bits, of 255
    double light = 0.0;      ///< at most, in linear light: shows that a variant does change the arithmetic
};

struct Spread {
    Golden golden;
    std::optional<Maker> maker;  ///< who drew the first variant
    std::map<std::string, Moved> by_variant;
    Moved most;                   ///< of each metric
    bool holds = false;           ///< the class allows twice as much
    bool could_be_exact = false;  ///< no variant changes an 8-bit picture
};
/// Pictures are left in `output`/VARIANT.
std::vector<Spread> calibrate(const std::vector<Golden>& goldens, const std::filesystem::path& output,
                              const DrawAll& draw_all);

/// The spreads as a page of Markdown, for version control. `command`: what makes it.
std::string table_of(const std::vector<Spread>& spreads, const std::string& command);

/// Whether `strictness` allows twice `most`.
bool allows_twice(const PixelDifference& most, Strictness strictness);

}  // namespace shvr::golden
