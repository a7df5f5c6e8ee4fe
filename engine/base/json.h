#pragma once
// Reading JSON strictly: every value is fetched by name with what is expected of it, and what does not fit is refused
// in one sentence that names the key in full:
//
//   scan.json: key render.step_voxels is -1; expected a number above 0 (0.0001 ... 1024)
//   scan.json: key volume.path is missing; expected the path of a volume file
//   strokes.jsonl:12: unknown key colour; expected one of: op, brush, threshold
//
// A value that is found is shown in at most 60 characters, on one line. Any thread; a document may be read by several.

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

/// Numbers that are accepted: from `lower` to `upper`, both included.
struct NumberRange {
    double lower;
    double upper;
    std::string expected{};  ///< empty: "a number from LOWER to UPPER"
    std::string sentence() const;
};
/// All finite numbers.
NumberRange any_number();
/// From `lower`, which is above 0, to `upper`.
NumberRange above_zero(double lower, double upper);

/// What a text must keep to before its values are looked at.
struct JsonLimits {
    int depth = 16;                      ///< levels of nesting; reading and showing values takes stack for each
    const char* expected = "an object";  ///< instead of what is not JSON, or nests deeper
    bool may_repeat_keys = false;        ///< the last one holds: for the metadata of other programs
};

class JsonDocument;

/// A value and where it stands in its document; it may be missing. Refers to the document, which must outlive it.
class JsonNode {
public:
    bool exists() const { return value_ != nullptr; }
    bool is_null() const;
    bool is_text() const;
    bool is_number() const;
    bool is_object() const;
    bool is_array() const;
    bool is(std::string_view text) const;  ///< whether it is this text
    size_t count() const;                  ///< of an array's elements; 0 for anything else

    /// "FILE: key KEY is VALUE; expected EXPECTED", or "... is missing; expected ..."
    std::string refusal(const std::string& expected) const;
    [[noreturn]] void refuse(const std::string& expected) const { throw Error(refusal(expected)); }
    [[noreturn]] void refuse_because(const std::string& reason) const;
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
    void allow(std::span<const std::string_view> known) const;
    void allow(std::initializer_list<std::string_view> known) const { allow(std::span(known.begin(), known.size())); }
    JsonNode operator[](std::string_view name) const;  ///< missing where this is no object that has it
    JsonNode required(std::string_view name, const std::string& expected) const;
    std::vector<std::string> names() const;  ///< of an object's members; fails for anything else
    /// Of an array of at least `least` and at most `most`; fails for anything else.
    std::vector<JsonNode> elements(size_t least = 0, size_t most = SIZE_MAX) const;

    // The value; these fail where it is missing.
    double number(const NumberRange& range) const;
    int64_t whole(int64_t lower, int64_t upper) const;  ///< 3.0 is whole
    bool flag() const;
    std::string text(const std::string& expected = "a text that is not empty") const;  ///< not empty
    std::string any_text(const std::string& expected = "a text") const;                ///< may be empty
    glm::dvec3 vector(const NumberRange& range) const;
    glm::i64vec3 size(int64_t largest) const;  ///< each 1 ... `largest`
    /// One of `names`: which.
    size_t choice(std::span<const std::string_view> names) const;
    /// A value of an enumeration that has `spellings_of`.
    template <class Value>
    Value choice() const
    {
        const std::span<const Spelling<Value>> spellings = spellings_of(Value{});
        return spellings[choice(names_of(spellings))].value;
    }
    /// What `parse` makes of a text, an optional; fails where that is nothing.
    template <class Parse>
    auto parsed(const Parse& parse, const std::string& expected) const
    {
        const auto value = is_text() ? parse(any_text()) : decltype(parse(std::string())){};
        if (!value) refuse(expected);
        return *value;
    }
    std::string dump() const;  ///< as JSON without spaces

    // The value, or `fallback` where it is missing.
    double number(double fallback, const NumberRange& range) const { return exists() ? number(range) : fallback; }
    int64_t whole(int64_t fallback, int64_t lower, int64_t upper) const
    {
        return exists() ? whole(lower, upper) : fallback;
    }
    bool flag(bool fallback) const { return exists() ? flag() : fallback; }
    std::string text_or(const std::string& fallback) const { return exists() ? text() : fallback; }
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
    // Of a missing value: the innermost object that is there, and the rest of the key. The key of a value that is there
    // is found by searching the document, which only a refusal does.
    const nlohmann::json* parent_ = nullptr;
    std::string missing_;
};

/// A parsed text and the name that messages give it: a file, or "file:line".
class JsonDocument {
public:
    /// Fails where the text is not JSON, repeats a key within one object, or nests too deep.
    JsonDocument(std::string_view text, std::string origin, const JsonLimits& limits = {});
    JsonDocument(const JsonDocument&) = delete;
    JsonDocument(JsonDocument&&) noexcept;
    ~JsonDocument();

    JsonNode root() const { return {*this, value_.get()}; }
    const std::string& origin() const { return origin_; }
    /// For changes; nodes made before are no longer valid.
    nlohmann::json& value() { return *value_; }
    const nlohmann::json& value() const { return *value_; }

private:
    std::string origin_;
    std::unique_ptr<nlohmann::json> value_;
};

/// A file's document, of at most `max_bytes`.
JsonDocument read_json(const std::filesystem::path& file, int64_t max_bytes, const JsonLimits& limits = {});

}  // namespace shvr
