#include "engine/formats/zarr/zarr_json.h"

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {
namespace {

constexpr int DEEPEST = 64;

}  // namespace

nlohmann::json read_json_object(const std::filesystem::path& path, int64_t max_bytes)
{
    const std::string text = read_text(path, max_bytes);
    // Every level of nesting costs memory many times its two characters.
    const auto check_depth = [&](int depth, nlohmann::json::parse_event_t /*event*/, nlohmann::json& /*value*/) {
        if (depth > DEEPEST) fail(path.string(), ": is nested more than ", DEEPEST, " deep; expected plain metadata");
        return true;
    };
    const nlohmann::json document = nlohmann::json::parse(text, check_depth, false);
    if (document.is_discarded()) fail(path.string(), ": is not valid JSON; expected an object");
    if (!document.is_object()) fail(path.string(), ": is ", shown(document), "; expected an object");
    return document;
}

std::string shown(const nlohmann::json& value)
{
    constexpr size_t LONGEST = 60;
    if (value.is_structured() && value.size() > LONGEST) return sentence("a list of ", value.size());
    const std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    return text.size() <= LONGEST ? text : text.substr(0, LONGEST) + "...";
}

void refuse_json(const std::filesystem::path& path, const std::string& key, const nlohmann::json& value,
                 const std::string& expected)
{
    fail(path.string(), ": ", key, " is ", shown(value), "; expected ", expected);
}

const nlohmann::json& required(const std::filesystem::path& path, const nlohmann::json& object, const char* key,
                               const std::string& expected)
{
    const auto found = object.find(key);
    if (found == object.end()) fail(path.string(), ": ", key, " is missing; expected ", expected);
    return *found;
}

}  // namespace shvr
