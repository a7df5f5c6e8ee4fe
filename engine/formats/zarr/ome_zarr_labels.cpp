#include "engine/formats/zarr/ome_zarr_labels.h"

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/formats/zarr/zarr_json.h"

namespace shvr {

namespace {

using Json = nlohmann::json;

std::optional<int64_t> label_of(const Json& entry)
{
    if (!entry.is_object()) return std::nullopt;
    const auto value = entry.find("label-value");
    if (value == entry.end() || !value->is_number_integer()) return std::nullopt;
    // What does not fit into int64_t is unsigned.
    if (value->is_number_unsigned() && value->get<uint64_t>() > uint64_t{INT64_MAX}) return std::nullopt;
    return value->get<int64_t>();
}

std::optional<std::array<uint8_t, 4>> rgba_of(const Json& rgba)
{
    const auto is_channel = [](const Json& c) { return c.is_number_integer() && c >= Json(0) && c <= Json(255); };
    if (!rgba.is_array() || rgba.size() != 4 || !std::ranges::all_of(rgba, is_channel)) return std::nullopt;
    std::array<uint8_t, 4> channels{};
    for (size_t i = 0; i < 4; ++i) channels[i] = rgba[i].get<uint8_t>();
    return channels;
}

class Reader {
public:
    Reader(std::filesystem::path path, LabelLooks& result) : path_(std::move(path)), result_(result) {}

    /// `take` returns whether the entry is one.
    template <class Take>
    void go_through(const Json& label, const char* key, const char* expected, const Take& take)
    {
        const auto list = label.find(key);
        if (list == label.end()) return;
        if (!list->is_array()) return warn(key, *list, "a list");
        size_t left_out = 0;
        for (const Json& entry : *list)
            if (!take(entry) && left_out++ == 0)
                warn(sentence(key, "[", &entry - &list->front(), "]"), entry, expected);
    }

private:
    void warn(const std::string& key, const Json& value, const char* expected)
    {
        result_.warnings.push_back(sentence(path_.string(), ": image-label.", key, " is ", shown(value), "; expected ",
                                            expected, "; it is left out"));
    }
    std::filesystem::path path_;
    LabelLooks& result_;
};

}  // namespace

LabelLooks read_label_looks(const std::filesystem::path& folder)
{
    LabelLooks result;
    const std::filesystem::path path = folder / ".zattrs";
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return result;
    const Json attributes = read_json_object(path, LARGEST_ZARR_ATTRIBUTES);
    const auto label = attributes.find("image-label");
    if (label == attributes.end() || !label->is_object()) return result;
    std::map<int64_t, LabelLook> looks;
    Reader reader(path, result);
    reader.go_through(*label, "colors", "a label-value and an rgba of four whole numbers from 0 to 255",
                      [&](const Json& entry) {
                          const std::optional<int64_t> value = label_of(entry);
                          if (!value) return false;
                          const auto found = entry.find("rgba");
                          if (found == entry.end()) return true;  // the reader is to choose
                          const auto rgba = rgba_of(*found);
                          if (rgba) looks.try_emplace(*value, LabelLook{*value, rgba, {}});
                          return rgba.has_value();
                      });
    std::map<int64_t, std::string> names;
    reader.go_through(*label, "properties", "a label-value, and a name that is a text", [&](const Json& entry) {
        const std::optional<int64_t> value = label_of(entry);
        if (!value) return false;
        const auto name = entry.find("name");
        if (name == entry.end()) return true;  // properties of other kinds
        if (!name->is_string()) return false;
        names.try_emplace(*value, name->get<std::string>());
        return true;
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
