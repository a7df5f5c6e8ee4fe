#pragma once
// Keys of JSON objects. Each key is defined once: name, value, range, unit and meaning. A function
// `fields(Fields&, Value&)` visits the keys in the order in which they are written. Reading, writing and the tables of
// the documentation are visitors:
//
//   void fields(Fields& f, Light& light)
//   {
//       f.number("ambient", light.ambient, {0.0, 10.0}, {"share of the colour that is always seen"});
//       ...
//
// Sessions, actions and preferences are such objects. Any thread.

#include <concepts>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/json.h"

namespace shvr {

/// The documentation of a key.
struct About {
    const char* meaning = "";   ///< one line; empty for sections that need no explanation
    const char* unit = "";      ///< printed before the range
    const char* allowed = "";   ///< printed instead of unit and range
    const char* standard = "";  ///< text for the default if this is not a plain value
    bool is_required = false;
};

/// Visits the values of an object by their keys. Unset optional values, empty texts and empty paths are not written.
/// Reading leaves a value unchanged if its key is missing from the file.
class Fields {
public:
    using Visit = std::function<void(Fields&)>;
    using VisitItem = std::function<void(Fields&, size_t index, size_t count)>;
    using VisitEntry = std::function<void(Fields&, const std::string& key)>;
    virtual ~Fields() = default;

    void flag(std::string_view name, bool& value, const About& about);
    void number(std::string_view name, double& value, const NumberRange& range, const About& about);
    virtual void number(std::string_view name, std::optional<double>& value, const NumberRange& range,
                        const About& about) = 0;
    template <std::integral Whole>
    void whole(std::string_view name, Whole& value, int64_t lower, int64_t upper, const About& about)
    {
        std::optional<int64_t> number = int64_t(value);
        any_whole(name, number, lower, upper, about);
        value = Whole(number.value_or(int64_t(value)));
    }
    /// An enumeration for which `spellings_of` exists.
    template <class Value>
    void choice(std::string_view name, Value& value, const About& about)
    {
        const std::span<const Spelling<Value>> spellings = spellings_of(value);
        std::string chosen(spelled(value));
        choice(name, chosen, names_of(spellings), about);
        for (const Spelling<Value>& each : spellings)
            if (each.name == chosen) value = each.value;
    }
    virtual void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                        const About& about) = 0;
    virtual void text(std::string_view name, std::string& value, const About& about) = 0;
    virtual void path(std::string_view name, std::filesystem::path& value, const About& about) = 0;
    void color(std::string_view name, glm::dvec3& value, const About& about);
    void color(std::string_view name, std::optional<glm::dvec3>& value, const About& about);
    /// Linear light; with alpha, if `has_alpha`.
    virtual void color(std::string_view name, std::optional<glm::dvec4>& value, bool has_alpha, const About& about) = 0;
    void vector(std::string_view name, glm::dvec3& value, const NumberRange& range, const About& about);
    virtual void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange& range,
                        const About& about) = 0;
    /// Reads as many numbers as `value` has.
    virtual void numbers(std::string_view name, std::optional<glm::dvec2>& value, const NumberRange& range,
                         const About& about) = 0;
    virtual void wholes(std::string_view name, std::vector<int64_t>& value, int64_t lower, int64_t upper,
                        const About& about) = 0;
    virtual void any_flag(std::string_view name, std::optional<bool>& value, const About& about) = 0;
    virtual void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t lower, int64_t upper,
                           const About& about) = 0;
    /// Visits a value with its own format: `read` parses it; `written` returns its JSON, or null to leave it out.
    virtual void other(std::string_view name, const std::function<void(const JsonNode&)>& read,
                       const std::function<std::optional<std::string>()>& written, const About& about) = 0;

    /// Visits an object, whose fields `visit` visits; `visit` may be called more than once.
    virtual void section(std::string_view name, const Visit& visit, const About& about = {}) = 0;
    template <class Value>
    void section(std::string_view name, Value& value, const About& about = {})
    {
        section(
            name, [&](Fields& f) { fields(f, value); }, about);
    }
    /// An array of at most `most` objects.
    virtual void items(std::string_view name, size_t count, size_t most, const VisitItem& visit,
                       const About& about) = 0;
    template <class Value>
    void list(std::string_view name, std::vector<Value>& values, size_t most, const About& about)
    {
        const auto visit = [&](Fields& f, size_t index, size_t count) {
            values.resize(count);
            fields(f, values[index]);
        };
        items(name, values.size(), most, visit, about);
    }
    /// Visits an object whose members are objects. `about` describes a member, which the table calls `placeholder`.
    virtual void entries(std::string_view name, std::vector<std::string> keys, std::string_view placeholder,
                         const VisitEntry& visit, const About& about) = 0;

    /// Whether a key is present: in the file when reading, otherwise `is_set`.
    virtual bool has(std::string_view name, bool is_set) = 0;
    /// States that a key is valid in this object although it is not visited this time.
    virtual void mention(std::string_view name, const About& about) = 0;
    /// States a key of earlier versions: reading ignores its value, and writing leaves it out.
    virtual void retired(std::string_view /*name*/) {}
    /// Refuses the input unless `holds`; an empty `name` means the section itself.
    virtual void check(std::string_view /*name*/, bool /*holds*/, const std::string& /*expected*/) {}
    /// Runs a check that throws its own errors, and prefixes their messages with the section's key.
    virtual void checked(const std::function<void()>&) {}
};

/// Reads an object by its keys. Fails on keys that are unknown, missing or have invalid values. Paths are relative to
/// `folder`.
void read_fields(const JsonNode& node, const std::filesystem::path& folder, const Fields::Visit& visit);
/// Returns the object as one line of JSON. Fails if a text is not valid UTF-8.
std::string write_fields(const std::filesystem::path& folder, const Fields::Visit& visit);

}  // namespace shvr
