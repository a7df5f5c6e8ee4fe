#include "engine/session/transfer_presets.h"

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "engine/base/assets.h"
#include "engine/base/file.h"
#include "engine/session/session_json.h"

namespace shvr {

namespace {

constexpr int64_t LARGEST_FILE = 1 << 20;

}  // namespace

TransferPreset parse_transfer_preset(const std::string& text, const std::string& name, const std::string& origin)
{
    const nlohmann::json json = json_of(text, origin);
    const JsonNode document(json, origin);
    document.expect_object({"note", "points"});
    TransferPreset preset{.name = name, .note = document.required("note", "a sentence").text("")};
    double last = -1.0;
    for (const JsonNode& element : document.required("points", "an array").elements()) {
        element.expect_object({"at", "color", "opacity"});
        ControlPoint point;
        point.intensity = element.required("at", "a share").number(0.0, {last, 10.0, ""});
        point.color = element.required("color", "a colour").color(point.color);
        point.opacity = element.required("opacity", "a number from 0 to 1").number(0.0, {0.0, 1.0, ""});
        last = point.intensity;
        preset.points.push_back(point);
    }
    if (preset.points.size() < 2) document["points"].refuse("at least two points");
    return preset;
}

std::vector<TransferPreset> transfer_presets()
{
    std::vector<std::filesystem::path> files;
    const std::filesystem::path folder = asset_folder("transfer_functions");
    if (!folder.empty())
        for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<TransferPreset> presets;
    for (const std::filesystem::path& file : files)
        presets.push_back(parse_transfer_preset(read_text(file, LARGEST_FILE), file.stem().string(), file.string()));
    return presets;
}

TransferPreset transfer_preset_named(const std::string& name)
{
    const std::vector<TransferPreset> presets = transfer_presets();
    const auto found = std::ranges::find(presets, name, &TransferPreset::name);
    if (found != presets.end()) return *found;
    std::string names;
    for (const TransferPreset& preset : presets) names += (names.empty() ? "" : ", ") + preset.name;
    fail("transfer_function.preset is \"", name, "\"; expected one of: ", names);
}

TransferFunction transfer_function_of(const TransferPreset& preset, const VolumeStatistics& statistics)
{
    const TissueRange tissue = tissue_range(statistics);
    std::vector<ControlPoint> points = preset.points;
    for (ControlPoint& point : points) point.intensity = tissue.lower + point.intensity * (tissue.upper - tissue.lower);
    if (const double maximum = statistics.range().upper; points.back().intensity < maximum) {
        points.push_back(points.back());
        points.back().intensity = maximum;
    }
    return TransferFunction(std::move(points));
}

}  // namespace shvr
