#include "engine/tasks/task_options.h"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace shvr {

namespace {

constexpr int MAX_THREADS = 1024;

}  // namespace

std::string option_name(OptionNames names, std::string_view key)
{
    if (names == OptionNames::keys) return std::string(key);
    std::string name = "--" + std::string(key);
    std::ranges::replace(name, '_', '-');
    return name;
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
