#pragma once
// Reads JSON strictly: callers fetch every value by name and state what they expect. Anything else is refused in one
// sentence that gives the full key:
//
//   scan.json: key render.step_voxels is -1; expected a number above 0 (0.0001 ... 1024)
//   scan.json: key volume.path is missing; expected the path of a volume file
//   strokes.jsonl:12: unknown key colour; expected one of: op, brush, threshold
//
// Messages show at most 60 characters of a value, on one line. Any thread; several threads may read one document.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>

#include "engine/base/error.h"
#include "engine/base/spelling.h"

namespace shvr {

/// The range of accepted numbers: from `lower` to `upper`, both inclusive.
struct NumberRange {
    double lower;
    double upper;
    std::string expected{};  ///< empty: "a number from LOWER to UPPER"
    std::string sentence() const;
};
/// All finite numbers.
NumberRange any_number();
/// Returns the range from `lower`, which must be above 0, to `upper`; messages then say "a number above 0".
NumberRange above_zero(double lower, double upper);

/// Limits on a text, checked before its values are read.
struct JsonLimits {
    int depth = 16;                      ///< maximum nesting; reading and printing values takes stack space per level
    const char* expected = "an object";  ///< added to the message if the text is not JSON or nests too deeply
    bool may_repeat_keys = false;        ///< accept repeated keys (the last one counts), for metadata of other programs
};

class JsonDocument;

/// A value in a document, or the place of a missing value. Refers to the document, which must outlive the node.
class JsonNode {
public:
    bool exists() const { return value_ != nullptr; }
    bool is_null() const;
    bool is_text() const;
    bool is_number() const;
    bool is_object() const;
    bool is_array() const;
    bool is(std::string_view text) const;  ///< whether the value is the string `text`
    size_t count() const;                  ///< elements of an array; 0 for anything else

    /// Returns the message "FILE: key KEY is VALUE; expected EXPECTED", or "... is missing; expected ...".
    std::string refusal(const std::string& expected) const;
    [[noreturn]] void refuse(const std::string& expected) const { throw Error(refusal(expected)); }
    [[noreturn]] void refuse_because(const std::string& reason) const;
    /// Runs `read`; if it throws an `Error`, prefixes the key to the error's message.
    template <class Read>
    auto checked(const Read& read) const
    {
        try {
            return read();
        } catch (const Error& error) {
            refuse_because(error.what());
        }
    }

    /// Fails if the value is not an object, or has a key that is not in `known`.
    void allow(std::span<const std::string_view> known) const;
    void allow(std::initializer_list<std::string_view> known) const { allow(std::span(known.begin(), known.size())); }
    JsonNode operator[](std::string_view name) const;  ///< the member `name`; missing if this is no object or lacks it
    JsonNode required(std::string_view name, const std::string& expected) const;
    std::vector<std::string> names() const;  ///< keys of an object's members; fails for anything else
    /// The elements of an array, at least `least` and at most `most` of them; fails for anything else.
    std::vector<JsonNode> elements(size_t least = 0, size_t most = SIZE_MAX) const;

    // The functions below return the value, and fail if it is missing.
    double number(const NumberRange& range) const;
    int64_t whole(int64_t lower, int64_t upper) const;  ///< 3.0 counts as whole
    bool flag() const;
    std::string text(const std::string& expected = "a text that is not empty") const;  ///< not empty
    std::string any_text(const std::string& expected = "a text") const;                ///< may be empty
    glm::dvec3 vector(const NumberRange& range) const;
    glm::i64vec3 size(int64_t largest) const;  ///< each 1 ... `largest`
    /// The value's index in `names`.
    size_t choice(std::span<const std::string_view> names) const;
    /// A value of an enumeration that has a function `spellings_of` (spelling.h).
    template <class Value>
    Value choice() const
    {
        const std::span<const Spelling<Value>> spellings = spellings_of(Value{});
        return spellings[choice(names_of(spellings))].value;
    }
    /// Applies `parse`, which returns an optional, to a text value; fails if the optional is empty.
    template <class Parse>
    auto parsed(const Parse& parse, const std::string& expected) const
    {
        const auto value = is_text() ? parse(any_text()) : decltype(parse(std::string())){};
        if (!value) refuse(expected);
        return *value;
    }
    std::string dump() const;  ///< serialized as JSON without spaces

    // The functions below return the value or, if the value is missing, `fallback`.
    double number(double fallback, const NumberRange& range) const { return exists() ? number(range) : fallback; }
    int64_t whole(int64_t fallback, int64_t lower, int64_t upper) const
    {
        return exists() ? whole(lower, upper) : fallback;
    }
    bool flag(bool fallback) const { return exists() ? flag() : fallback; }
    glm::dvec3 vector(const glm::dvec3& fallback, const NumberRange& range) const
    {
        return exists() ? vector(range) : fallback;
    }
    glm::i64vec3 size(const glm::i64vec3& fallback, int64_t largest) const
    {
        return exists() ? size(largest) : fallback;
    }
    template <class Value>
    Value choice_or(Value fallback) const
    {
        return exists() ? choice<Value>() : fallback;
    }

private:
    friend class JsonDocument;
    JsonNode(const JsonDocument& document, const nlohmann::json* value) : document_(&document), value_(value) {}
    std::string key() const;
    std::string subject() const;
    std::string key_of(const std::string& name) const;

    const JsonDocument* document_;
    const nlohmann::json* value_;
    // If the value is missing: the innermost object that exists, and the rest of the key below it. The key of an
    // existing value is not stored: a refusal finds it by searching the document.
    const nlohmann::json* parent_ = nullptr;
    std::string missing_;
};

/// A parsed text and its name in messages: a file, or "file:line".
class JsonDocument {
public:
    /// Fails if the text is not JSON, repeats a key within one object, or nests too deeply.
    JsonDocument(std::string_view text, std::string origin, const JsonLimits& limits = {});
    JsonDocument(const JsonDocument&) = delete;
    JsonDocument(JsonDocument&&) noexcept;
    ~JsonDocument();

    JsonNode root() const { return {*this, value_.get()}; }
    const std::string& origin() const { return origin_; }
    /// For modifications; they invalidate existing nodes.
    nlohmann::json& value() { return *value_; }
    const nlohmann::json& value() const { return *value_; }

private:
    std::string origin_;
    std::unique_ptr<nlohmann::json> value_;
};

/// Reads a file of at most `max_bytes`.
JsonDocument read_json(const std::filesystem::path& file, int64_t max_bytes, const JsonLimits& limits = {});

}  // namespace shvr
