#include "engine/session/transfer_presets.h"

#include <algorithm>
#include <filesystem>

#include "engine/base/assets.h"
#include "engine/base/file.h"
#include "engine/session/session_keys.h"

namespace shvr {

namespace {

constexpr int64_t LARGEST_FILE = 1 << 20;

}  // namespace

TransferPreset parse_transfer_preset(const std::string& text, const std::string& name, const std::string& origin)
{
    const JsonDocument json(text, origin, {.expected = "a transfer function"});
    const JsonNode document = json.root();
    document.allow({"note", "points"});
    TransferPreset preset{.name = name, .note = document["note"].text("a sentence")};
    double last = -1.0;
    for (const JsonNode& element : document["points"].elements()) {
        element.allow({"at", "color", "opacity"});
        ControlPoint point;
        point.intensity = element["at"].number({last, 10.0});
        point.color = read_color(element["color"]);
        point.opacity = element["opacity"].number(SHARE);
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
