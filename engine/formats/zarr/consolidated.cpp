#include "engine/formats/zarr/consolidated.h"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/formats/zarr/store/zarr_json.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int64_t MAX_BYTES = int64_t{256} << 20;
constexpr int MAX_DEPTH = 3;  ///< maximum depth of arrays below the image, as in v1/0

std::optional<Json> json_of(const fs::path& file)
{
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return std::nullopt;
    try {
        return Json(read_zarr_json(file, MAX_BYTES).value());
    } catch (const Error&) {
        return std::nullopt;
    }
}

bool is_array(const fs::path& node)
{
    std::error_code ignored;
    if (fs::exists(node / ".zarray", ignored)) return true;
    const std::optional<Json> document = json_of(node / "zarr.json");
    return document && document->value("node_type", Json()) == "array";
}

/// Returns the groups and arrays from `group`, a group above the image, down to the image's arrays; relative paths.
std::vector<fs::path> nodes_of(const fs::path& image, const fs::path& group, std::initializer_list<const char*> names)
{
    std::vector<fs::path> nodes;
    const auto add = [&](const fs::path& folder) {
        const auto has = [&](const char* name) {
            std::error_code ignored;
            return fs::exists(folder / name, ignored);
        };
        if (std::ranges::none_of(names, has)) return;
        const fs::path node = folder.lexically_relative(group);
        nodes.push_back(node == "." ? fs::path() : node);
    };
    for (fs::path above = image.parent_path(); above != group; above = above.parent_path()) add(above);
    add(group);
    add(image);
    std::error_code ignored;
    // Does not search the folders of arrays, which contain only chunks.
    for (auto at = fs::recursive_directory_iterator(image, ignored); at != fs::end(at); at.increment(ignored)) {
        if (!at->is_directory(ignored)) continue;
        add(at->path());
        if (is_array(at->path()) || at.depth() + 1 >= MAX_DEPTH) at.disable_recursion_pending();
    }
    return nodes;
}

void erase_below(Json& metadata, const std::string& node)
{
    Json rest = Json::object();
    for (auto& [key, value] : metadata.items())
        if (key != node && !key.starts_with(node + "/")) rest[key] = std::move(value);
    metadata = std::move(rest);
}

void renew_2(const fs::path& group, const fs::path& image, const std::string& inner)
{
    const fs::path file = group / ".zmetadata";
    std::optional<Json> document = json_of(file);
    if (!document || !document->contains("metadata") || !document->at("metadata").is_object()) return;
    const Json before = *document;
    Json& metadata = document->at("metadata");
    erase_below(metadata, inner);
    const std::initializer_list<const char*> names = {".zarray", ".zgroup", ".zattrs"};
    for (const fs::path& node : nodes_of(image, group, names))
        for (const char* const name : names) {
            const std::optional<Json> found = json_of(group / node / name);
            const std::string key = (node / name).generic_string();
            if (found)
                metadata[key] = *found;
            else
                metadata.erase(key);
        }
    if (*document == before) return;
    const std::string text = document->dump(4, ' ', false, Json::error_handler_t::replace);
    write_file_atomically(file, std::as_bytes(std::span(text)));
}

void renew_3(const fs::path& group, const fs::path& image, const std::string& inner)
{
    const fs::path file = group / "zarr.json";
    std::optional<Json> document = json_of(file);
    if (!document || !document->contains("consolidated_metadata")) return;
    Json& consolidated = document->at("consolidated_metadata");
    if (!consolidated.is_object() || !consolidated.contains("metadata") || !consolidated["metadata"].is_object())
        return;
    const Json before = consolidated;
    Json& metadata = consolidated["metadata"];
    erase_below(metadata, inner);
    for (const fs::path& node : nodes_of(image, group, {"zarr.json"}))
        if (std::optional<Json> found = node.empty() ? std::nullopt : json_of(group / node / "zarr.json"))
            metadata[node.generic_string()] = std::move(*found);
    if (consolidated == before) return;
    const std::string text = document->dump(2, ' ', false, Json::error_handler_t::replace);
    write_file_atomically(file, std::as_bytes(std::span(text)));
}

}  // namespace

void renew_consolidated_metadata(const fs::path& image)
{
    fs::path group = image.parent_path();
    for (int levels = 0; levels < 2 && group.has_relative_path(); ++levels, group = group.parent_path()) {
        const std::string inner = image.lexically_relative(group).generic_string();
        renew_2(group, image, inner);
        renew_3(group, image, inner);
    }
}

}  // namespace shvr
