#include "engine/formats/slices/skyscan_log.h"

#include <cmath>
#include <map>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/header_fields.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

/// Maximum number of logs in a folder to consider.
constexpr int MAX_LOGS = 1000;

/// Returns the log whose name is the longest prefix of the slice's name, among the logs in the slice's folder.
std::optional<fs::path> log_of(const fs::path& slice)
{
    const std::string name = lower_case(slice.filename().string());
    std::optional<fs::path> found;
    size_t longest = 0;
    int logs = 0;
    std::error_code error;
    for (fs::directory_iterator entry(slice.parent_path(), error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
        const fs::path& path = entry->path();
        if (lower_case(path.extension().string()) != ".log" || ++logs > MAX_LOGS) continue;
        const std::string stem = lower_case(path.stem().string());
        std::error_code unreadable;
        if (stem.size() <= longest || !name.starts_with(stem) || !entry->is_regular_file(unreadable)) continue;
        longest = stem.size();
        found = path;
    }
    return found;
}

/// Returns the values of the log by lower-case key; keys in the section [Reconstruction] become "reconstruction/KEY".
std::map<std::string, std::string> values_of(const fs::path& log)
{
    std::map<std::string, std::string> values;
    const std::string text = read_head(log);
    std::string_view rest = text;
    bool is_reconstruction = false, was_reconstruction = false;
    while (!rest.empty()) {
        const std::string_view line = trimmed(take_line(rest));
        if (line.starts_with('[')) {
            was_reconstruction = was_reconstruction || is_reconstruction;
            is_reconstruction = lower_case(line) == "[reconstruction]";
        }
        const size_t equals = line.find('=');
        if (equals == std::string_view::npos) continue;
        std::string key = lower_case(trimmed(line.substr(0, equals)));
        if (is_reconstruction)
            values["reconstruction/" + key] = trimmed(line.substr(equals + 1));
        else
            values.try_emplace(key, trimmed(line.substr(equals + 1)));
    }
    return values;
}

}  // namespace

void apply_skyscan_log(const fs::path& slice, VolumeInfo& info)
{
    const std::optional<fs::path> log = log_of(slice);
    if (!log) return;
    const std::string name = log->filename().string();
    try {
        const std::map<std::string, std::string> values = values_of(*log);
        const auto number = [&](const std::string& key) -> std::optional<double> {
            const auto found = values.find(key);
            if (found == values.end()) return std::nullopt;
            const std::optional<double> value = number_of(found->second);
            if (!value || !(*value > 0.0) || !std::isfinite(*value))
                fail(name, ": ", key, " is ", in_quotes(found->second), "; expected a number above 0");
            return value;
        };
        std::optional<double> pixel = number("reconstruction/pixel size (um)");
        if (!pixel) pixel = number("image pixel size (um)");
        if (!pixel) pixel = number("pixel size (um)");
        if (!pixel) return;  // the log of another program
        for (const auto& [key, side] : {std::pair("reconstruction/result image width (pixels)", info.size.x),
                                        std::pair("reconstruction/result image height (pixels)", info.size.y)})
            if (const std::optional<double> stated = number(key); stated && *stated != double(side))
                fail(name, ": ", key, " is ", *stated, "; expected ", side, ", as the slices have");
        const double step = number("reconstruction/section to section step").value_or(1.0);
        const glm::dvec3 spacing = *pixel * glm::dvec3(1.0, 1.0, step);
        const std::optional<double> um = micrometres_in(plain_unit(info.unit));
        const bool states_other = info.spacing_from == Provenance::file && um &&
                                  glm::length(*um * glm::dvec2(info.spacing) - glm::dvec2(spacing)) > 1e-3 * *pixel;
        if (states_other)
            info.warnings.push_back(sentence("the slices state a spacing of ",
                                             spacing_in_words(info.spacing, info.unit), "; that of ", name,
                                             " is taken: ", spacing_in_words(spacing, "um")));
        std::erase_if(info.warnings, [](const std::string& warning) {
            return warning.starts_with("no spacing stated") || warning.starts_with("no distance of ") ||
                   warning.starts_with("spacing is stated without a unit");
        });
        info.spacing = spacing;
        info.unit = "um";
        info.spacing_from = info.unit_from = Provenance::file;
    } catch (const Error& error) {
        info.warnings.push_back(sentence(error.what(), "; this log is left out"));
    }
}

}  // namespace shvr
