#pragma once
// Reading JSON strictly: every value is fetched by name with what is expected of it, and what does not fit is refused
// in one sentence that names the key in full. For the session_*.cpp files only. Any thread.

#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>

#include "engine/base/error.h"
#include "engine/session/session.h"

namespace shvr {

/// Numbers that are accepted: from `lower` to `upper`, both included.
struct NumberRange {
    double lower;
    double upper;
    std::string expected;  ///< empty: "a number from LOWER to UPPER"
};

/// A value and where it stands in the document; the value may be missing. Refers to the document and to `origin`, which
/// must both outlive it.
class JsonNode {
public:
    JsonNode(const nlohmann::json& root, const std::string& origin) : value_(&root), origin_(&origin) {}

    bool exists() const { return value_ != nullptr; }
    bool is_text() const;
    bool is_object() const;
    [[noreturn]] void refuse(const std::string& expected) const;
    /// Runs `read` and puts the key in front of the `Error` it may throw.
    template <class Read>
    auto checked(const Read& read) const
    {
        try {
            return read();
        } catch (const Error& error) {
            refuse_because(error.what());
        }
    }

    /// Fails where this is no object, or holds a key that is not among `known`.
    void expect_object(std::initializer_list<const char*> known) const;
    JsonNode operator[](const std::string& name) const;
    /// Fails where it is missing.
    JsonNode required(const std::string& name, const std::string& expected) const;
    std::vector<std::string> names() const;  ///< of an object's members; fails for anything else
    std::vector<JsonNode> elements() const;  ///< of an array; fails for anything else

    // The value, or `fallback` where it is missing.
    double number(double fallback, const NumberRange& range) const;
    int64_t whole(int64_t fallback, int64_t lower, int64_t upper) const;
    bool flag(bool fallback) const;
    std::string text(const std::string& fallback) const;  ///< not empty
    glm::dvec3 vector(const glm::dvec3& fallback, const NumberRange& range) const;
    Size3 size(const Size3& fallback) const;                       ///< each 1 ... 2^20
    glm::dvec3 color(const glm::dvec3& fallback) const;            ///< "#rrggbb", to linear light
    glm::dvec4 color_and_alpha(const glm::dvec4& fallback) const;  ///< "#rrggbb" or "#rrggbbaa"
    template <class Value>
    Value choice(Value fallback, const std::map<std::string, Value>& values) const;

private:
    JsonNode(const nlohmann::json* value, std::string key, const std::string* origin)
        : value_(value), key_(std::move(key)), origin_(origin)
    {}
    std::string key_of(const std::string& name) const { return key_.empty() ? name : key_ + "." + name; }
    std::string subject() const;
    [[noreturn]] void refuse_because(const std::string& reason) const;
    double finite_number(const NumberRange& range) const;

    const nlohmann::json* value_;
    std::string key_;
    const std::string* origin_;
};

template <class Value>
Value JsonNode::choice(Value fallback, const std::map<std::string, Value>& values) const
{
    if (!exists()) return fallback;
    if (const auto found = values.find(is_text() ? text("") : ""); found != values.end()) return found->second;
    std::string expected;
    for (const auto& [name, value] : values) expected += (expected.empty() ? "one of \"" : ", \"") + name + "\"";
    refuse(expected);
}

/// Fails where the text is not JSON, names a key twice in one object, or nests deeper than any session does.
nlohmann::json json_of(const std::string& text, const std::string& origin);

/// Applies "key=value" settings; `document` must be an object.
void apply_settings(nlohmann::json& document, const std::vector<std::string>& settings);

CameraSpec read_camera(const JsonNode& node);
/// Whether a camera is given as an object, not by name.
bool is_camera_object(const std::string& name_or_json);

Session read_session(const nlohmann::json& document, const std::filesystem::path& folder, const std::string& origin);

}  // namespace shvr
