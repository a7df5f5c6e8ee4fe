#include "engine/tasks/task_options.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <nlohmann/json.hpp>

namespace shvr {

namespace {

constexpr int MAX_THREADS = 1024;

/// Titles that are not just the words of the key. They fit into the left column of a dialog.
constexpr std::pair<std::string_view, const char*> TITLES[] = {
    {"allow_incomplete", "Skip unreadable"},
    {"budget_host_mib", "Memory in MiB"},
    {"decimate", "Triangles to keep"},
    {"frame", "Time point"},
    {"mesh", "Trace as tubes"},
    {"metrics", "Measures"},
    {"offset", "Density offsets"},
    {"ome_zarr", "OME-Zarr version"},
    {"raw", "Bare voxels"},
    {"slack", "Tolerance"},
    {"smooth", "Smooth surfaces"},
    {"space", "Positions"},
    {"truth_group", "Reference groups"},
    {"truth_mask", "Reference mask"},
    {"truth_trace", "Reference trace"},
};

}  // namespace

std::string option_name(OptionNames names, std::string_view key)
{
    if (names == OptionNames::keys) return std::string(key);
    if (names == OptionNames::titles) return option_title(key);
    std::string name = "--" + std::string(key);
    std::ranges::replace(name, '_', '-');
    return name;
}

std::string option_title(std::string_view key)
{
    const auto known = std::ranges::find(TITLES, key, &std::pair<std::string_view, const char*>::first);
    if (known != std::end(TITLES)) return known->second;
    std::string title(key);
    std::ranges::replace(title, '_', ' ');
    if (!title.empty() && title[0] >= 'a' && title[0] <= 'z') title[0] = char(title[0] - 'a' + 'A');
    return title;
}

void version_field(Fields& f, std::optional<OmeZarrVersion>& version, const char* automatic)
{
    constexpr const char* AUTOMATIC = "automatic";
    std::vector<std::string_view> names{AUTOMATIC};
    for (const Spelling<OmeZarrVersion>& each : OME_ZARR_VERSIONS) names.push_back(each.name);
    std::string chosen(version ? spelled(*version) : AUTOMATIC);
    f.choice("ome_zarr", chosen, names, {.meaning = automatic});
    version.reset();
    for (const Spelling<OmeZarrVersion>& each : OME_ZARR_VERSIONS)
        if (each.name == chosen) version = each.value;
}

void incomplete_field(Fields& f, bool& allows_incomplete, const char* counts_as)
{
    f.flag("allow_incomplete", allows_incomplete, {counts_as});
}

Gaps gaps_of(bool allows_incomplete, OptionNames names)
{
    if (allows_incomplete) return Gaps();
    return Gaps(option_name(names, "allow_incomplete") + " goes on without what cannot be read");
}

void threads_field(Fields& f, int& threads)
{
    f.whole("threads", threads, 0, MAX_THREADS, {"that work; 0: one per core"});
}

void check_threads(int threads, OptionNames names)
{
    if (threads < 0 || threads > MAX_THREADS)
        throw UsageError(sentence(option_name(names, "threads"), " is ", threads, "; expected 0 to ", MAX_THREADS));
}

void texts_field(Fields& f, std::string_view name, std::vector<std::string>& texts, const About& about)
{
    const auto read = [&](const JsonNode& node) {
        texts.clear();
        for (const JsonNode& each : node.elements()) texts.push_back(each.text());
    };
    const auto written = [&] { return texts.empty() ? std::nullopt : std::optional(nlohmann::json(texts).dump()); };
    f.other(name, read, written, about);
}

}  // namespace shvr
