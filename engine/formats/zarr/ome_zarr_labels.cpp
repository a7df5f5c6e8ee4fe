#include "engine/formats/zarr/ome_zarr_labels.h"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/zarr/store/zarr_node.h"

namespace shvr {

namespace {

std::optional<std::array<uint8_t, 4>> rgba_of(const JsonNode& node)
{
    std::array<uint8_t, 4> channels{};
    const std::vector<JsonNode> elements = node.elements(4, 4);
    for (size_t i = 0; i < 4; ++i) channels[i] = uint8_t(elements[i].whole(0, 255));
    return channels;
}

/// Calls `take`, which fails for invalid entries, for each entry. Only the first failure adds a warning (`expected`).
template <class Take>
void go_through(const JsonNode& list, const char* expected, std::vector<std::string>& warnings, const Take& take)
{
    const auto leave_out = [&](const std::string& refusal) { warnings.push_back(refusal + "; it is left out"); };
    if (!list.exists()) return;
    if (!list.is_array()) return leave_out(list.refusal("a list"));
    bool has_warned = false;
    for (const JsonNode& entry : list.elements()) try {
            take(entry);
        } catch (const Error&) {
            if (!std::exchange(has_warned, true)) leave_out(entry.refusal(expected));
        }
}

}  // namespace

bool is_ome_zarr_label(const std::filesystem::path& folder)
{
    try {
        const std::optional<ZarrNode> node = read_zarr_node(folder);
        return node && node->ome()["image-label"].exists();
    } catch (const Error&) {
        return false;
    }
}

std::vector<std::string> read_label_header(const std::filesystem::path& folder)
{
    const std::optional<ZarrNode> node = read_zarr_node(folder);
    if (!node) return {};
    const JsonNode list = node->attributes()["shvr"]["nrrd_header"];
    std::vector<std::string> lines;
    if (list.exists())
        for (const JsonNode& line : list.elements()) lines.push_back(line.any_text());
    return lines;
}

LabelLooks read_label_looks(const std::filesystem::path& folder)
{
    LabelLooks result;
    const std::optional<ZarrNode> node = read_zarr_node(folder);
    if (!node) return result;
    const JsonNode label = node->ome()["image-label"];
    if (!label.is_object()) return result;
    const auto value_of = [](const JsonNode& entry) { return entry["label-value"].whole(INT64_MIN, INT64_MAX); };
    std::map<int64_t, LabelLook> looks;
    go_through(label["colors"], "a label-value and an rgba of four whole numbers from 0 to 255", result.warnings,
               [&](const JsonNode& entry) {
                   const int64_t value = value_of(entry);
                   const JsonNode rgba = entry["rgba"];  // without "rgba", the reader chooses a colour
                   if (rgba.exists()) looks.try_emplace(value, LabelLook{value, rgba_of(rgba), {}});
               });
    std::map<int64_t, std::string> names;
    go_through(label["properties"], "a label-value, and a name that is a text", result.warnings,
               [&](const JsonNode& entry) {
                   const int64_t value = value_of(entry);
                   const JsonNode name = entry["name"];  // entries without "name" have properties of other kinds
                   if (name.exists()) names.try_emplace(value, name.any_text());
               });
    for (auto& [value, name] : names) {
        LabelLook& look = looks[value];
        look.value = value;
        look.name = std::move(name);
    }
    for (auto& [value, look] : looks) result.looks.push_back(std::move(look));
    return result;
}

}  // namespace shvr
