#include "tests/support/bounds.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/at_end.h"

namespace shvr::test {

namespace {

struct Found {
    double error = 0.0, bound = 0.0;
    int64_t inputs = 0, worst_input = 0;  ///< from 1
    std::string worst;
    /// The used share of the bound, which decides on the worst input.
    double share() const { return bound > 0.0 ? error / bound : error; }
};

/// Results by file, test case and measured quantity.
using Cases = std::map<std::tuple<std::string, std::string, std::string>, Found>;

Cases& cases()
{
    static Cases all;
    return all;
}

std::string captured()
{
    std::ostringstream text;
    for (int i = 0; i < doctest::IReporter::get_num_active_contexts(); ++i) {
        if (i > 0) text << ", ";
        doctest::IReporter::get_active_contexts()[i]->stringify(&text);
    }
    return text.str();
}

void write_cases(const char* path)
{
    std::ofstream file(path);
    for (const auto& [key, found] : cases())
        file << nlohmann::ordered_json{{"file", std::get<0>(key)},
                                       {"test", std::get<1>(key)},
                                       {"what", std::get<2>(key)},
                                       {"error", found.error},
                                       {"bound", found.bound},
                                       {"inputs", found.inputs},
                                       {"worst_input", found.worst_input},
                                       {"worst", found.worst}}
                    .dump()
             << "\n";
    if (!file.flush()) std::abort();
}

void remember(const char* path, const std::string& what, double error, double bound)
{
    if (cases().empty()) at_end([path] { write_cases(path); });
    const auto& test = *doctest::getContextOptions()->currentTest;
    std::string file = test.m_file.c_str();
    file = file.substr(std::min(file.rfind("tests/"), file.size()));
    Found& found = cases()[{file, test.m_name, what}];
    const int64_t input = found.inputs + 1;
    const Found now{error, bound, input, input, captured()};
    if (found.inputs == 0 || now.share() > found.share())
        found = now;
    else
        ++found.inputs;
}

}  // namespace

void check_below(const std::string& what, double error, double bound)
{
    REQUIRE(std::isfinite(bound));
    if (const char* path = std::getenv("SHVR_STABILITY")) remember(path, what, error, bound);
    INFO(what, ": ", error, ", at most ", bound);
    CHECK(error <= bound);
}

}  // namespace shvr::test
